# glowworm - the lighting baker for point clouds. `make help` lists the targets.

PREFIX  ?= /usr/local
DESTDIR ?=
BUILD   ?= build
CC      ?= gcc
CXX     ?= g++
GLSLC   ?= glslc

# config=release (default) or config=sanitize
config  ?= release
ifeq ($(config),sanitize)
BUILD   := build/sanitize
OPT     := -O1 -g -fsanitize=address,undefined -fno-sanitize-recover=undefined -fno-omit-frame-pointer
else
OPT     := -O2 -g -D_FORTIFY_SOURCE=2 -fstack-protector-strong
endif

WARN     := -Wall -Wextra -Wshadow -Wconversion
INCLUDE  := -Ilib -Iformats -Icli -Ishaders -I$(BUILD)/shaders
CFLAGS   += -std=c17 -D_GNU_SOURCE $(OPT) $(WARN) -fPIC -pthread -ffp-contract=off $(INCLUDE)
CXXFLAGS += -std=c++17 -D_GNU_SOURCE $(OPT) -Wall -Wextra -fPIC -pthread -ffp-contract=off $(INCLUDE) \
            -isystem /usr/include/pcl-1.13 -isystem /usr/include/eigen3 -isystem /usr/include/OpenEXR -isystem /usr/include/Imath
LDFLAGS  += $(OPT) -pthread -Wl,--as-needed -Wl,-z,relro,-z,now
LDLIBS   += -lvulkan -lflann -llz4 -ljansson -lm

# OpenVDB takes 40 ms to load, so it is a shared object that is opened when a grid is written.
VDB_SOURCE      := formats/vdb_grids.cpp
VDB_RUN_PATH    := -Wl,-rpath,'$$ORIGIN:$$ORIGIN/../lib/glowworm'

LIB_SOURCES     := $(wildcard lib/*.c lib/*.cpp)
FORMATS_SOURCES := $(filter-out $(VDB_SOURCE),$(wildcard formats/*.c formats/*.cpp))
CLI_SOURCES     := $(wildcard cli/*.c)
objects          = $(addprefix $(BUILD)/,$(addsuffix .o,$(basename $(1))))
SHADERS         := $(wildcard shaders/*.comp)
SPIRV           := $(SHADERS:shaders/%.comp=$(BUILD)/shaders/%.spv.inc)

.PHONY: all help clean FORCE
all: $(BUILD)/glowworm $(BUILD)/libglowworm-vdb.so  ## build the program

$(BUILD)/glowworm: $(call objects,$(CLI_SOURCES) $(FORMATS_SOURCES)) $(BUILD)/libglowworm.a
	$(CXX) $(LDFLAGS) $(VDB_RUN_PATH) -o $@ $^ $(LDLIBS)

$(BUILD)/libglowworm-vdb.so: $(call objects,$(VDB_SOURCE))
	$(CXX) $(LDFLAGS) -shared -o $@ $^ -lopenvdb -ltbb

$(BUILD)/libglowworm.a: $(call objects,$(LIB_SOURCES))
	@rm -f $@
	$(AR) rcs $@ $^

$(BUILD)/%.o: %.c
	@mkdir -p $(@D)
	$(CC) $(CPPFLAGS) $(CFLAGS) -MMD -MP -c -o $@ $<

$(BUILD)/%.o: %.cpp
	@mkdir -p $(@D)
	$(CXX) $(CPPFLAGS) $(CXXFLAGS) -MMD -MP -c -o $@ $<

# Shaders become comma-separated words that lib/shaders.c includes.
$(BUILD)/shaders/%.spv.inc: shaders/%.comp
	@mkdir -p $(@D)
	$(GLSLC) --target-env=vulkan1.2 -O -mfmt=num -Ishaders -MD -MF $(BUILD)/shaders/$*.d -MT $@ -o $@ $<

# One array for each shader and a table of them; touched only when a shader comes or goes.
$(BUILD)/shaders/shader_list.inc: FORCE
	@mkdir -p $(@D)
	@{ for shader in $(basename $(notdir $(SHADERS))); do \
		printf 'static const uint32_t shader_%s[] = {\n#include "%s.spv.inc"\n};\n' $$shader $$shader; \
	done; \
	echo 'static const gw_shader shader_list[] = {'; \
	for shader in $(basename $(notdir $(SHADERS))); do \
		printf '\t{ "%s", shader_%s, sizeof shader_%s / 4 },\n' $$shader $$shader $$shader; \
	done; echo '};'; } > $@.new
	@cmp -s $@.new $@ && rm $@.new || mv $@.new $@

$(BUILD)/lib/shaders.o: $(SPIRV) $(BUILD)/shaders/shader_list.inc

help:  ## list the targets
	@grep -hE '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed -E 's/:.*## /\t/' | expand -t 14

clean:  ## remove what was built
	rm -rf build

-include $(wildcard $(BUILD)/*/*.d $(BUILD)/*/*/*.d)
