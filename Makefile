# glowworm - the lighting baker for point clouds. `make help` lists the targets.

PREFIX  ?= /usr/local
DESTDIR ?=
LIBDIR  ?= $(PREFIX)/lib
ZSHDIR  ?= $(PREFIX)/share/zsh/site-functions
BUILD   ?= build
JOBS    ?= $(shell nproc)
CC      ?= gcc
CXX     ?= g++
GLSLC   ?= glslc

PIE     := -pie

# What is the same in all configurations is built once: the shaders.
SHADER_BUILD := $(BUILD)/shaders

# config=release (default), config=sanitize, config=coverage, or config=fuzz with clang
config  ?= release
ifeq ($(config),sanitize)
BUILD   := build/sanitize
# A report names lines and functions; to describe variables as well doubles the time of kernels.
# Undefined behaviour is an illegal instruction, which AddressSanitizer reports with its line: what
# UBSan would say of each check makes 10 MB, which LeakSanitizer reads at the end of each process.
OPT     := -O1 -g1 -fsanitize=address,undefined -fsanitize-undefined-trap-on-error -fno-omit-frame-pointer
# Between the many checks in a kernel the best registers are looked for in vain, for half the time.
KERNEL_FLAGS := -fira-algorithm=priority -fira-region=one
# What sanitizers write beside the code is full of addresses: to relocate them takes a third of a
# start, and tells them nothing.
PIE     := -no-pie
FOR_TESTS := $(BUILD)/tests/keep_loaded.o
else ifeq ($(config),coverage)
BUILD   := build/coverage
OPT     := -O1 -g --coverage -fprofile-update=atomic
FOR_TESTS := $(BUILD)/tests/write_counts.o
else ifeq ($(config),fuzz)
BUILD   := build/fuzz
CC      := clang
CXX     := clang++
OPT     := -O1 -g -fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=undefined \
           -Wno-string-conversion
else
# What stands between a fault of ours and a hostile file that finds it, as far as the compiler and
# the processor know it; tests/lint/check_hardening.sh looks for each in the program.
known   = $(shell for flag in $(1); do \
	$(CC) $$flag -Werror -fsyntax-only -x c /dev/null 2>/dev/null && echo $$flag; done)
FORTIFY := $(shell $(CC) -O2 -U_FORTIFY_SOURCE -D_FORTIFY_SOURCE=3 -Werror -include stdio.h \
	-fsyntax-only -x c /dev/null 2>/dev/null && echo 3 || echo 2)
HARDEN  := $(call known,-fstack-protector-strong -fstack-clash-protection -fcf-protection) \
	-U_FORTIFY_SOURCE -D_FORTIFY_SOURCE=$(FORTIFY)
OPT     := -O2 -g $(HARDEN)
endif

WARN     := -Wall -Wextra -Wformat=2
WARN_C   := $(WARN) -Wshadow -Wconversion -Wvla -Wstrict-prototypes \
            -Werror=implicit-function-declaration
INCLUDE  := -Ilib -Iformats -Icli -Ishaders -I$(SHADER_BUILD) -I$(BUILD)
CFLAGS   += -std=c17 -D_GNU_SOURCE $(OPT) $(WARN_C) -fPIC -pthread -ffp-contract=off $(INCLUDE)
CXXFLAGS += -std=c++17 -D_GNU_SOURCE -D_GLIBCXX_ASSERTIONS $(OPT) $(WARN) -fPIC -pthread -ffp-contract=off $(INCLUDE) \
            -isystem /usr/include/pcl-1.13 -isystem /usr/include/eigen3 -isystem /usr/include/OpenEXR -isystem /usr/include/Imath
LDFLAGS  += $(OPT) -pthread -Wl,--as-needed -Wl,-z,relro,-z,now,-z,noexecstack
LDLIBS   += -lvulkan -llz4 -ljansson -lexpat -llzf -lpng -lz -lOpenEXRCore -lOpenEXR -lm

comma    := ,

# For shared objects; a sanitizer's functions are in the program.
NO_UNKNOWN := $(if $(filter sanitize fuzz,$(config)),,-Wl$(comma)-z$(comma)defs)

# OpenVDB takes 40 ms to load and PROJ 6, so that each is a shared object that is opened when a grid
# is written or a file names a coordinate system; so is MPI, which need not be there, when mpirun
# starts several processes. The run path is the old kind, which is also seen when a sanitizer calls
# dlopen for us.
VDB_SOURCE      := formats/grids/vdb_grids.cpp
PROJ_SOURCE     := formats/units/proj_system.c
MPI_SOURCE      := cli/program/mpi_ranks.c
MPI             := $(shell pkg-config --exists ompi-c 2>/dev/null && echo ompi-c)
PLUGINS         := $(addprefix $(BUILD)/libglowworm-,vdb.so proj.so $(if $(MPI),mpi.so))
PLUGIN_RUN_PATH := -Wl,--disable-new-dtags,-rpath,'$$ORIGIN:$$ORIGIN/../lib/glowworm'

LIB_SOURCES     := $(filter-out lib/light/kernel.cpp,$(wildcard lib/*/*.c lib/*/*.cpp))
FORMATS_SOURCES := $(filter-out $(VDB_SOURCE) $(PROJ_SOURCE),$(wildcard formats/*/*.c formats/*/*.cpp))
CLI_SOURCES     := $(filter-out $(MPI_SOURCE),$(wildcard cli/*/*.c))
PUBLIC_HEADERS  := $(wildcard lib/*.h)
objects          = $(addprefix $(BUILD)/,$(addsuffix .o,$(basename $(1))))
SHADERS         := $(wildcard shaders/*/*.comp)
SPIRV           := $(SHADERS:shaders/%.comp=$(SHADER_BUILD)/%.spv.inc)

# What tests and benchmarks link: the program without its main function, and their own helpers.
MAIN_SOURCE     := $(shell grep -ls '^int main\>' cli/*/*.c)
TESTS           := $(wildcard $(foreach d,unit physics hostile,tests/$(d)/test_*.c tests/$(d)/test_*.cpp))
BENCHES         := $(wildcard tests/bench/bench_*.c tests/bench/bench_*.cpp)
BENCH_TOOLS     := $(wildcard tests/bench/make_*.c tests/fuzz/make_*.c)
PCL_LOADERS     := tests/bench/pcl_loaders.cpp
TORTURE_SHIM    := tests/torture/fault_shim.c
TORTURE_SOURCES := $(filter-out $(TORTURE_SHIM),$(wildcard tests/torture/*.c))
TEST_HELPERS    := $(filter-out $(TESTS) $(BENCHES) $(BENCH_TOOLS) $(PCL_LOADERS) $(TORTURE_SHIM) $(TORTURE_SOURCES),$(wildcard tests/*/*.c tests/*/*.cpp))
TEST_PROGRAMS   := $(addprefix $(BUILD)/,$(basename $(TESTS)))
BENCH_PROGRAMS  := $(addprefix $(BUILD)/,$(basename $(BENCHES)))
TORTURE         := $(addprefix $(BUILD)/tests/torture/,torture fault_shim.so)
TOOL_PROGRAMS   := $(addprefix $(BUILD)/,$(basename $(BENCH_TOOLS)))
SAMPLE_PROGRAMS := $(BUILD)/samples/make_cave $(BUILD)/samples/make_box
LIBRARY_SAMPLE  := $(BUILD)/samples/relight_room

# The shared library: until 1.0 structs may change from one minor version to the next, so that the
# soname has both numbers.
VERSION := $(shell sed -n 's/.*define GW_VERSION "\(.*\)"/\1/p' lib/glowworm.h)
SONAME  := libglowworm.so.$(basename $(VERSION))
SHARED  := libglowworm.so.$(VERSION)

# Passes that run on the processor as well: lib/light/kernel.cpp, compiled with the text of each.
KERNELS         := device/prefix_sum light/light_visibility light/light_irradiance \
                   light/facet_direct light/record_rays light/record_again light/record_emitters \
                   light/record_sky light/record_portals light/portal_light \
                   light/record_first light/record_gather light/record_moments \
                   light/record_share light/record_add \
                   light/facet_weights light/facet_shade light/read_back \
                   light/volume_rays light/volume_fill light/volume_weights light/volume_read \
                   light/volume_faces light/volume_inject light/volume_spread \
                   light/probe_sight light/probe_rays \
                   picture/given_rays picture/cache_rays picture/cache_mips picture/pixel_caches
KERNEL_OBJECTS  := $(KERNELS:%=$(BUILD)/kernels/%_kernel.o)
KERNEL_OF        = -DPASS=gw_kernel_$(notdir $(1)) -DPASS_TEXT='"$(1).comp"'
LIB_OBJECTS     := $(call objects,$(LIB_SOURCES)) $(KERNEL_OBJECTS)

# Pages of the manual and completions, of which the program itself writes what repeats its options.
MAN_PAGES       := $(patsubst %.in,$(BUILD)/%,$(wildcard man/*.1.in))
COMPLETIONS     := $(addprefix $(BUILD)/completion.,bash zsh fish)

.PHONY: all check deb deps deps-deb deps-interop demo dist gallery manual release-check test test-interop test-sanitize test-programs sanitized-programs chosen-programs analysis coverage torture fuzz valgrind bench bench-formats tradeoff lint install uninstall help clean FORCE
all: $(BUILD)/glowworm $(PLUGINS) $(BUILD)/libglowworm.so $(SAMPLE_PROGRAMS) $(LIBRARY_SAMPLE) \
		$(MAN_PAGES) $(COMPLETIONS)  ## build program, library and samples

$(BUILD)/glowworm: $(call objects,$(CLI_SOURCES) $(FORMATS_SOURCES)) $(BUILD)/libglowworm.a
	$(CXX) $(LDFLAGS) $(PIE) $(PLUGIN_RUN_PATH) -o $@ $^ $(LDLIBS)

# Where templates of others are from is no help to anyone, and takes a third of the longest
# compilation.
$(call objects,$(VDB_SOURCE) lib/normals/plane_normal.cpp lib/cloud/neighbour_index.cpp): \
	CXXFLAGS += -g1

# All that it takes has to be there, since part of OpenVDB is taken from its library as compiled:
# with -DVDB_OWN_TEMPLATES in CPPFLAGS it is not.
$(BUILD)/libglowworm-vdb.so: $(call objects,$(VDB_SOURCE))
	$(CXX) $(LDFLAGS) -shared $(NO_UNKNOWN) -o $@ $^ -lopenvdb -ltbb -lImath

$(BUILD)/libglowworm-proj.so: $(call objects,$(PROJ_SOURCE))
	$(CC) $(LDFLAGS) -shared -o $@ $^ -lproj -lm

MPI_INCLUDE     := $(if $(MPI),$(shell pkg-config --cflags-only-I $(MPI)))
$(call objects,$(MPI_SOURCE)): OWN_FLAGS := $(patsubst -I%,-isystem %,$(MPI_INCLUDE))
$(BUILD)/analysis/$(MPI_SOURCE).txt: CFLAGS += $(MPI_INCLUDE)

$(BUILD)/libglowworm-mpi.so: $(call objects,$(MPI_SOURCE))
	$(CC) $(LDFLAGS) -shared -o $@ $^ $(shell pkg-config --libs $(MPI))

$(BUILD)/libglowworm.a: $(LIB_OBJECTS)
	@rm -f $@
	$(AR) rcs $@ $^

# Only what the public headers declare is visible from outside.
LIB_FLAGS := -fvisibility=hidden
$(LIB_OBJECTS): OWN_FLAGS := $(LIB_FLAGS)

$(BUILD)/$(SHARED): $(LIB_OBJECTS) lib/libglowworm.map
	$(CXX) $(LDFLAGS) -shared -Wl,-soname,$(SONAME) -Wl,--version-script=lib/libglowworm.map \
		$(NO_UNKNOWN) \
		-o $@ $(filter %.o,$^) $(LDLIBS)

$(BUILD)/libglowworm.so: $(BUILD)/$(SHARED)
	ln -sf $(SHARED) $(BUILD)/$(SONAME)
	ln -sf $(SONAME) $@

$(LIBRARY_SAMPLE): $(LIBRARY_SAMPLE).o $(BUILD)/libglowworm.so
	$(CC) $(LDFLAGS) -Wl,-rpath,'$$ORIGIN/..' -o $@ $< -L$(BUILD) -lglowworm -lm

# How all is built, for `glowworm doctor`; what was built otherwise is built anew.
BUILD_FLAGS := $(BUILD)/build_flags.inc
$(BUILD_FLAGS): FORCE
	@mkdir -p $(@D)
	@echo '"$(strip $(filter-out -I% -W% -ffile-prefix-map=%,$(CFLAGS)) $(filter -Wl$(comma)%,$(LDFLAGS)))"' \
		'/* lib: $(LIB_FLAGS) */' >$@.new
	@cmp -s $@.new $@ && rm $@.new || mv $@.new $@

$(BUILD)/%.o: %.c $(BUILD_FLAGS)
	@mkdir -p $(@D)
	$(CC) $(CPPFLAGS) $(CFLAGS) $(OWN_FLAGS) -MMD -MP -c -o $@ $<

$(BUILD)/%.o: %.cpp $(BUILD_FLAGS)
	@mkdir -p $(@D)
	$(CXX) $(CPPFLAGS) $(CXXFLAGS) $(OWN_FLAGS) -MMD -MP -c -o $@ $<

$(KERNEL_OBJECTS): $(BUILD)/kernels/%_kernel.o: lib/light/kernel.cpp shaders/%.comp $(BUILD_FLAGS)
	@mkdir -p $(@D)
	$(CXX) $(CPPFLAGS) $(CXXFLAGS) $(OWN_FLAGS) $(KERNEL_FLAGS) -Werror=double-promotion \
		$(call KERNEL_OF,$*) -MMD -MP -c -o $@ $<

# Shaders become comma-separated words that lib/device/shaders.c includes. A header that is gone must
# not stop the next build, so each gets an empty rule, as -MP gives those of C.
$(SHADER_BUILD)/%.spv.inc: shaders/%.comp
	@mkdir -p $(@D)
	$(GLSLC) -std=460 --target-env=vulkan1.2 -O -mfmt=num -Ishaders -MD -MF $(SHADER_BUILD)/$*.d -MT $@ -o $@ $<
	@sed -e 's/^[^:]*://' $(@:.spv.inc=.d) | tr -s ' \\' '\n' | sed -e '/./s/$$/:/' >$@.absent
	@cat $@.absent >>$(@:.spv.inc=.d) && rm $@.absent

# One array for each shader and a table of them; touched only when a shader comes or goes.
$(SHADER_BUILD)/shader_list.inc: FORCE
	@mkdir -p $(@D)
	@{ for shader in $(SHADERS:shaders/%.comp=%); do \
		printf 'static const uint32_t shader_%s[] = {\n#include "%s.spv.inc"\n};\n' $${shader##*/} $$shader; \
	done; \
	echo 'static const gw_shader shader_list[] = {'; \
	for shader in $(basename $(notdir $(SHADERS))); do \
		printf '\t{ "%s", shader_%s, sizeof shader_%s / 4 },\n' $$shader $$shader $$shader; \
	done; echo '};'; } > $@.new
	@cmp -s $@.new $@ && rm $@.new || mv $@.new $@

# The document, style and program of a page become bytes that cli/page/page_file.c includes.
PAGE_PROGRAM := $(addprefix cli/page/page_,points.js camera.js draw.js panel.js main.js)
PAGE_PARTS   := $(addprefix $(BUILD)/page/page.,html.inc css.inc js.inc)
$(BUILD)/page/page.html.inc: cli/page/page.html
$(BUILD)/page/page.css.inc: cli/page/page.css
$(BUILD)/page/page.js.inc: $(PAGE_PROGRAM)
$(PAGE_PARTS):
	@mkdir -p $(@D)
	@cat $^ | od -An -v -tx1 | sed -e 's/ \(..\)/0x\1,/g' >$@.new
	@mv $@.new $@

$(BUILD)/cli/page/page_file.o: $(PAGE_PARTS)

$(BUILD)/lib/device/shaders.o: $(SPIRV) $(SHADER_BUILD)/shader_list.inc

$(SAMPLE_PROGRAMS): $(BUILD)/%: $(BUILD)/%.o \
		$(addprefix $(BUILD)/samples/,sample_points.o sample_ptx.o sample_e57.o)
	$(CC) $(LDFLAGS) -o $@ $^ -lm

$(BUILD)/man/%.1: man/%.1.in $(BUILD)/glowworm
	@mkdir -p $(@D)
	$(BUILD)/glowworm --generate man-$* >$@.options
	sed -e '/^@OPTIONS@$$/{r $@.options' -e 'd}' \
		-e "s/@VERSION@/$$($(BUILD)/glowworm --version | cut -d ' ' -f 2)/" $< >$@.new
	@rm $@.options && mv $@.new $@

# What the samples' generators say of their options stands as they print it.
$(BUILD)/man/make_%.1: man/make_%.1.in $(BUILD)/samples/make_%
	@mkdir -p $(@D)
	$(BUILD)/samples/make_$* --help | sed -e 's/-/\\-/g' >$@.options
	sed -e '/^@OPTIONS@$$/{r $@.options' -e 'd}' -e 's/@VERSION@/$(VERSION)/' $< >$@.new
	@rm $@.options && mv $@.new $@

# All pages as one text, to be read or searched without man.
$(BUILD)/manual.txt: $(MAN_PAGES)
	@for page in $(sort $^); do groff -Kutf8 -Tutf8 -man -rLL=96n -P-cbou $$page || exit; done |\
		cat -s >$@.new
	@mv $@.new $@

manual: $(BUILD)/manual.txt

$(BUILD)/completion.%: $(BUILD)/glowworm
	$< --generate $* >$@.new
	@mv $@.new $@

# ------------------------------------------------------------------------------------- tests

$(BUILD)/libprogram.a: $(call objects,$(filter-out $(MAIN_SOURCE),$(CLI_SOURCES)) $(FORMATS_SOURCES))
	@rm -f $@
	$(AR) rcs $@ $^

$(BUILD)/libhelpers.a: $(call objects,$(TEST_HELPERS))
	@mkdir -p $(@D)
	@rm -f $@
	$(AR) rcs $@ $^

# A hundred programs that nobody installs are linked in two thirds of the time by gold, where it is,
# and in a third where no debugger will look at them: with NO_SYMBOLS=1, as `make test` does. Then their
# objects have no symbols either.
QUICK_LINKER    := $(if $(shell command -v ld.gold),-fuse-ld=gold) $(if $(NO_SYMBOLS),-Wl$(comma)-S)

$(BUILD)/tests/%.o: CFLAGS += $(if $(NO_SYMBOLS),-g0)
$(BUILD)/tests/%.o: CXXFLAGS += $(if $(NO_SYMBOLS),-g0)
$(BUILD)/tests/%.o: INCLUDE += -Itests/unit -Itests/physics -Itests/hostile -Itests/bench -Itests/fuzz
$(TEST_PROGRAMS) $(BENCH_PROGRAMS) $(TOOL_PROGRAMS): $(BUILD)/%: $(BUILD)/%.o $(BUILD)/libhelpers.a \
		$(BUILD)/libprogram.a $(BUILD)/libglowworm.a
	$(CXX) $(LDFLAGS) $(QUICK_LINKER) -Wl,--disable-new-dtags,-rpath,'$$ORIGIN/../..' -o $@ $(filter %.o,$^) $(filter %.a,$^) -lcmocka -lembree3 $(LDLIBS)

# They write grids as the samples do, which use nothing of ours.
GRID_WRITERS := $(addprefix $(BUILD)/tests/,bench/make_scan unit/test_grids)
$(addsuffix .o,$(GRID_WRITERS)): INCLUDE += -Isamples
$(GRID_WRITERS): $(addprefix $(BUILD)/samples/,sample_points.o sample_ptx.o sample_e57.o)

# Peers of our readers, which nothing else needs.
$(BUILD)/tests/bench/bench_formats: $(call objects,$(PCL_LOADERS))
$(BUILD)/tests/bench/bench_formats: LDLIBS += -lpcl_io -lpcl_common

$(BUILD)/tests/fuzz/fuzz: $(BUILD)/tests/fuzz/fuzz_main.o $(BUILD)/libhelpers.a \
		$(BUILD)/libprogram.a $(BUILD)/libglowworm.a
	$(CXX) $(LDFLAGS) -fsanitize=fuzzer -o $@ $^ $(LDLIBS)

# Only of builds with sanitizers or counters: see tests/keep_loaded.c, tests/write_counts.c.
$(BUILD)/glowworm $(TEST_PROGRAMS): $(FOR_TESTS)

# Many bakes in a program load the drivers once; the program itself closes them as its users see it.
$(TEST_PROGRAMS): $(BUILD)/tests/keep_loaded.o

# They count what readers allocate and make allocations fail.
$(BUILD)/tests/hostile/test_damaged $(BUILD)/tests/hostile/test_damaged_las: LDFLAGS += $(addprefix -Wl$(comma)--wrap=,malloc calloc realloc \
		reallocarray strdup strndup free)

# They see each pass that runs.
$(BUILD)/tests/unit/test_passes $(BUILD)/tests/physics/test_shaders: LDFLAGS += -Wl,--wrap=gw_passes_run

# It makes waits for the device seem to be in vain, refuses work, and sees what is destroyed.
$(BUILD)/tests/unit/test_stuck_driver: LDFLAGS += $(addprefix -Wl$(comma)--wrap=,vkWaitForFences vkQueueSubmit vkDestroyBuffer \
		vkFreeMemory)

# The campaign uses nothing of the program, so that it sees what the program does not; its shim is
# loaded before the C library.
$(BUILD)/tests/torture/torture: $(call objects,$(TORTURE_SOURCES))
	$(CC) $(LDFLAGS) -o $@ $^ -ljansson -lm

$(BUILD)/tests/torture/fault_shim.so: $(call objects,$(TORTURE_SHIM))
	$(CC) $(LDFLAGS) -shared -o $@ $^

# It makes calls of the system fail, and plans fewer settings.
$(BUILD)/tests/hostile/test_faulty_files: LDFLAGS += $(addprefix -Wl$(comma)--wrap=,open read pread write fsync \
		close fclose flock kill geteuid rename renameat2 statvfs gw_available_memory tradeoff_plan)

test-programs: all $(TEST_PROGRAMS) $(TORTURE) $(addprefix $(BUILD)/tests/bench/,bench_peers make_truth)

# Under sanitizers neither tests of physics nor the campaign run, and in `make test` only what
# tests/not_sanitized leaves.
SANITIZED_TESTS := $(filter-out $(BUILD)/tests/physics/%,$(TEST_PROGRAMS))
CHOSEN_TESTS    := $(filter-out $(addprefix $(BUILD)/,$(basename $(shell grep -v '^\#' tests/not_sanitized))), \
	$(SANITIZED_TESTS))

sanitized-programs: all $(SANITIZED_TESTS)

chosen-programs: all $(CHOSEN_TESTS)

# Recipes below run make again, silently and in parallel, so that only what is wrong is printed.
build_quietly = $(MAKE) --no-print-directory -s -j$(JOBS)
SANITIZED     = build/sanitize:unit build/sanitize:hostile build/sanitize:cli

check: deps  ## what a change breaks most often, in under two minutes: style, quick unit and cli tests
	@$(build_quietly) config=release all $(filter $(BUILD)/tests/unit/%,$(TEST_PROGRAMS))
	@tests/suite.sh build:style build:quick-unit build:quick-cli

# What is in tests/cli and tests/hostile runs once, under sanitizers or without: with WITH_PLAIN=1 all
# runs without as well.
test: deps  ## build and run all tests, and those that tests/not_sanitized leaves under sanitizers
	@$(build_quietly) config=release NO_SYMBOLS=1 test-programs analysis
	@$(build_quietly) config=sanitize chosen-programs
	@tests/suite.sh build:unit build:physics build:shaders build:torture build:lint \
		$(addprefix build:$(if $(WITH_PLAIN),,other-),hostile cli) \
		$(addprefix build/sanitize:chosen-,unit hostile cli) $(if $(WITH_INTEROP),build:interop)
	@tests/release/note_passed.sh build/tests_passed

test-interop: deps  ## what CloudCompare, MeshLab, Blender and others make of our files
	@$(build_quietly) all $(addprefix $(BUILD)/tests/bench/,bench_peers make_truth)
	@tests/suite.sh build:interop

torture: deps  ## hard clouds, faults, kills, fuzzing, for hours: make torture MINUTES=60 SEED=2
	@$(build_quietly) all $(TORTURE)
	@$(BUILD)/tests/torture/torture --seed $(or $(SEED),1) --minutes $(or $(MINUTES),0) \
		--jobs $(JOBS) $(if $(CASE),--case $(CASE)) --program $(BUILD)/glowworm

test-sanitize: deps  ## the tests under AddressSanitizer and UndefinedBehaviorSanitizer
	@$(build_quietly) config=sanitize sanitized-programs
	@tests/suite.sh $(SANITIZED)

coverage: deps  ## choose the tests that run under sanitizers by what they reach
	@$(build_quietly) config=coverage sanitized-programs
	@tests/coverage.sh

fuzz: deps  ## feed a reader damaged files: make fuzz READER=las MINUTES=5
	@$(build_quietly) config=fuzz $(addprefix build/fuzz/tests/fuzz/,fuzz make_corpus)
	@tests/fuzz/fuzz.sh build/fuzz "$(READER)" $(or $(MINUTES),5)

valgrind: deps  ## small runs of every kind under valgrind: make valgrind FILES="a.las b.e57"
	@$(build_quietly) all
	@tests/valgrind.sh $(BUILD) $(FILES)

# What clang's analyzer says of each file, kept until the file or what it includes changes. With
# 30,000 nodes a function it takes two thirds of the time, but warns of what is right. Its heap in pages
# of 2 MB, where the system has them, saves a fifth.
ANALYSED := $(patsubst %,$(BUILD)/analysis/%.txt,$(LIB_SOURCES) $(FORMATS_SOURCES) \
	$(VDB_SOURCE) $(PROJ_SOURCE) $(if $(MPI),$(MPI_SOURCE)) $(CLI_SOURCES) $(wildcard samples/*.c))
ANALYSE   = GLIBC_TUNABLES=glibc.malloc.hugetlb=1 clang --analyze -Xclang -analyzer-output=text -Xclang -analyzer-config \
	-Xclang max-nodes=75000 $(filter -std=% -D% -I%,$(1)) \
	$(addprefix -isystem ,$(filter /usr/include/%,$(1))) -MD -MP -MF $@.d -MT $@ -o $@.new $<

$(BUILD)/analysis/%.c.txt: %.c | $(SPIRV) $(SHADER_BUILD)/shader_list.inc $(BUILD_FLAGS)
	@mkdir -p $(@D)
	@$(call ANALYSE,$(CFLAGS)) 2>$@.new; mv $@.new $@

$(BUILD)/analysis/%.cpp.txt: %.cpp
	@mkdir -p $(@D)
	@$(call ANALYSE,$(CXXFLAGS)) 2>$@.new; mv $@.new $@

KERNELS_ANALYSED := $(KERNELS:%=$(BUILD)/analysis/kernels/%.txt)
$(KERNELS_ANALYSED): $(BUILD)/analysis/kernels/%.txt: lib/light/kernel.cpp shaders/%.comp
	@mkdir -p $(@D)
	@$(call ANALYSE,$(CXXFLAGS) $(call KERNEL_OF,$*)) 2>$@.new; mv $@.new $@

analysis: $(ANALYSED) $(KERNELS_ANALYSED)

lint: deps  ## style, layers, symbols, hardening, the analyzer's findings, the folders' READMEs
	@$(build_quietly) $(BUILD)/libglowworm.a $(BUILD)/libglowworm.so $(BUILD)/glowworm $(PLUGINS) analysis
	@tests/suite.sh $(BUILD):lint

bench: all $(BENCH_PROGRAMS) $(TOOL_PROGRAMS)  ## measure speed and error: tables, and build/bench.json
	@set -e; for program in $(filter-out %/bench_peers,$(BENCH_PROGRAMS)); do \
		echo "== $${program##*/}"; $$program; done
	@echo "== bench_table.py"; BUILD=$(BUILD) tests/bench/bench_table.py $(BUILD)/bench.json

bench-formats: all $(BUILD)/tests/bench/bench_formats  ## speed of reading and writing, into formats/speed.md
	@tests/bench/formats_table.sh $(BUILD) formats/speed.md 2000000 $(LAZ)

# -------------------------------------------------------------------------------------- use

deps:  ## install the Debian packages that are missing
	@tests/install_packages.sh .debian-packages

deps-interop:  ## the same for the programs that test-interop runs
	@tests/install_packages.sh .debian-packages-interop
	@tests/install_node_packages.sh build/interop

deps-deb:  ## the same for the programs that deb runs
	@tests/install_packages.sh .debian-packages-deb

demo: deps  ## make a cave, light it and say what came out
	@$(build_quietly) all
	@GLOWWORM=$(BUILD)/glowworm MAKE_CAVE=$(BUILD)/samples/make_cave samples/demo.sh $(BUILD)/demo

gallery: deps  ## pictures of the three sample scenes, with and without each effect
	@$(build_quietly) all
	@GLOWWORM=$(BUILD)/glowworm MAKE_CAVE=$(BUILD)/samples/make_cave \
		samples/gallery.sh $(BUILD)/gallery

tradeoff: deps  ## error, seconds and memory of many settings, into tests/bench/measured.md
	@$(build_quietly) all
	@GLOWWORM=$(BUILD)/glowworm MAKE_CAVE=$(BUILD)/samples/make_cave \
		samples/tradeoff.sh $(BUILD)/tradeoff tests/bench/measured.md

bin    = $(DESTDIR)$(PREFIX)/bin
shared = $(DESTDIR)$(PREFIX)/share
lib    = $(DESTDIR)$(LIBDIR)
plugin = $(DESTDIR)$(PREFIX)/lib/glowworm
header = $(DESTDIR)$(PREFIX)/include
SAMPLES          = $(wildcard $(addprefix samples/,*.scene.json *.obj *.mtl *.sh *.py relight_room.c README.md))

# The program looks for plugins in ../lib/glowworm of its own folder, wherever the library lies.
install: all  ## install under PREFIX (/usr/local), below DESTDIR if that is given; LIBDIR: the library
	install -D -t $(bin) $(BUILD)/glowworm $(SAMPLE_PROGRAMS)
	install -D -m 644 -t $(plugin) $(PLUGINS)
	install -D -m 644 -t $(lib) $(BUILD)/$(SHARED) $(BUILD)/libglowworm.a
	ln -sf $(SHARED) $(lib)/$(SONAME)
	ln -sf $(SONAME) $(lib)/libglowworm.so
	install -D -m 644 -t $(header) $(PUBLIC_HEADERS)
	mkdir -p $(lib)/pkgconfig
	sed -e 's|@PREFIX@|$(PREFIX)|; s|@LIBDIR@|$(LIBDIR:$(PREFIX)/%=$${prefix}/%)|' \
		-e 's|@VERSION@|$(VERSION)|' lib/libglowworm.pc.in >$(lib)/pkgconfig/libglowworm.pc
	install -D -m 644 -t $(shared)/glowworm/samples $(SAMPLES)
	chmod 755 $(shared)/glowworm/samples/*.sh $(shared)/glowworm/samples/*.py
	install -D -m 644 -t $(shared)/man/man1 $(MAN_PAGES)
	install -D -m 644 $(BUILD)/completion.bash $(shared)/bash-completion/completions/glowworm
	install -D -m 644 $(BUILD)/completion.zsh $(DESTDIR)$(ZSHDIR)/_glowworm
	install -D -m 644 $(BUILD)/completion.fish $(shared)/fish/vendor_completions.d/glowworm.fish

uninstall:  ## remove what install put there
	rm -f $(bin)/glowworm $(addprefix $(bin)/,$(notdir $(SAMPLE_PROGRAMS)))
	rm -rf $(plugin) $(shared)/glowworm
	rm -f $(addprefix $(lib)/,$(SHARED) $(SONAME) libglowworm.so libglowworm.a pkgconfig/libglowworm.pc)
	rm -f $(addprefix $(header)/,$(notdir $(PUBLIC_HEADERS)))
	rm -f $(addprefix $(shared)/man/man1/,$(notdir $(MAN_PAGES)))
	rm -f $(shared)/bash-completion/completions/glowworm $(DESTDIR)$(ZSHDIR)/_glowworm
	rm -f $(shared)/fish/vendor_completions.d/glowworm.fish

# ----------------------------------------------------------------------------------- release

dist:  ## the sources as build/dist/glowworm-VERSION.tar.gz, always the same bytes
	@tests/release/make_tarball.sh build/dist

deb: deps deps-deb  ## Debian packages of what is committed, into build/deb; lintian has to be silent
	@tests/release/make_deb.sh build/deb

release-check: deps deps-deb  ## what a release has to have, item by item; takes what `make test` left
	@$(build_quietly) config=release all
	@tests/release/check_release.sh build/release

help:  ## list the targets
	@grep -hE '^[a-z-]+:.*##' Makefile | sed -E 's/:.*## /\t/' | expand -t 15
	@echo; echo 'config=sanitize with all, test-programs or lint builds into build/sanitize'

clean:  ## remove what was built
	rm -rf build

-include $(sort $(wildcard $(BUILD)/*/*.d $(BUILD)/*/*/*.d $(SHADER_BUILD)/*/*.d))
