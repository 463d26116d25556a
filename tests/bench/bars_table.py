#!/usr/bin/env python3
"""What is asked of speed and memory, and what is measured, as a table.

    tests/bench/bars_table.py [ROW]...

ROW is a name of the first column, or a pattern; without one all are measured, of which those of 10
million points take many minutes and 10 GB. Figures are medians over the rounds; seconds are those of
the processor, of whole processes unless the command is bench_peers, whose seconds count from bare
points to light. Environment: that of bench_table.py, but SECONDS_A_WAY is 3600 by default.
"""
import fnmatch
import functools
import os
import shutil
import statistics
import sys

os.environ.setdefault("SECONDS_A_WAY", "3600")
import bench_table as bench

GOAL = 0.05
CAVE_POINTS = 1400000


def show(command):
    """As one types it from the root of the repository."""
    return "`" + " ".join(command).replace(bench.ROOT + os.sep, "") + "`"


@functools.cache
def make_cave():
    """The cave of the samples under its two spots."""
    folder = os.path.join(bench.WORK, f"cave-{CAVE_POINTS}")
    prefix = os.path.join(folder, "cave")
    if not os.path.exists(prefix + ".scene.json"):
        os.makedirs(folder, exist_ok=True)
        make = os.path.join(bench.BUILD, "samples", "make_cave")
        bench.run([make, "--points", str(CAVE_POINTS), "-o", prefix + ".ply"])
        shutil.copy(os.path.join(bench.ROOT, "samples", "cave.scene.json"), folder)
    return prefix


def middle(runs, what):
    return statistics.median(r[what] for r in runs)


def rounds(measure):
    return [measure() for _ in range(bench.ROUNDS)]


@functools.cache
def bakes(prefix, *options):
    """Whole processes. A target that is out of reach is exit code 1."""
    return rounds(lambda: bench.run(bench.bake_command(prefix, *options), fine=(0, 1)))


# ------------------------------------------------------------------------- rows: a ratio, its parts


def beside_cached(kind, points):
    """How many times as long as ours cached radiance takes to the goal."""
    prefix = bench.make_scene(kind, points)
    took, parts = {}, []
    for way in ("cached", "targets", "surfaces"):
        runs = rounds(lambda: bench.climb(prefix, way, GOAL))
        took[way] = bench.median_of([bench.reached(r, GOAL) for r in runs])
        megabytes = middle(runs, "peak_bytes") / 1e6
        parts.append(f"{way} {bench.number(took[way])} s, {bench.number(megabytes)} MB")
    reached = took["cached"] and took["targets"]
    command = show(bench.climb_command(prefix, "targets", GOAL))
    return took["cached"] / took["targets"] if reached else None, "; ".join(parts), command


def beside_default():
    """A target that edges alone keep out of reach, over default settings."""
    prefix, target = make_cave(), ("--max-error", str(GOAL))
    aimed, plain = (middle(bakes(prefix, *o), "processor_seconds") for o in (target, ()))
    command = show(bench.bake_command(prefix, *target))
    return aimed / plain, f"{aimed:.1f} s, default {plain:.1f}", command


def grown(what, unit, *options):
    """A Cornell box of 10 million points over one of a million."""
    small, large = (bench.make_scene("cornell", n) for n in (1000000, 10000000))
    few, many = (middle(bakes(p, *options), what) / unit for p in (small, large))
    return many / few, f"{many:.4g}, {few:.4g}", show(bench.bake_command(large, *options))


def second_over_first():
    """The same light over the kept transport."""
    runs = rounds(lambda: bench.light_again(make_cave()))
    first, again = (statistics.median(r[k]["processor_seconds"] for r in runs) for k in (0, 1))
    command = show(bench.bake_command(make_cave(), "--transport", make_cave() + ".transport"))
    return again / first, f"{again:.1f} s, first {first:.1f}", command


TARGET = ("--max-error", str(GOAL))
ROWS = {
    "cornell-1m": ("cached / ours to 5 %", ">= 4", lambda: beside_cached("cornell", 1000000)),
    "rooms-1m": ("cached / ours to 5 %", ">= 4", lambda: beside_cached("rooms", 1000000)),
    "cornell-10m": ("cached / ours to 5 %", ">= 10", lambda: beside_cached("cornell", 10000000)),
    "rooms-10m": ("cached / ours to 5 %", ">= 10", lambda: beside_cached("rooms", 10000000)),
    "out-of-reach": ("cave, target / default", "<= 1.5", beside_default),
    "second-light": ("cave, second light / first", "<= 1/12", second_over_first),
    "grown-s": ("10 / 1 million points, s", "<= 8", lambda: grown("processor_seconds", 1)),
    "grown-MB": ("10 / 1 million points, MB", "<= 8", lambda: grown("peak_bytes", 1e6)),
    "grown-target-s": ("the same to 5 %, s", "<= 8", lambda: grown("processor_seconds", 1, *TARGET)),
    "grown-target-MB": ("the same to 5 %, MB", "<= 8", lambda: grown("peak_bytes", 1e6, *TARGET)),
}


def holds(ratio, bar):
    sign, text = bar.split()
    top, _, bottom = text.partition("/")
    most = float(top) / float(bottom or 1)
    return ratio is not None and (ratio >= most if sign == ">=" else ratio <= most)


def main():
    wanted = sys.argv[1:] or ["*"]
    os.makedirs(bench.WORK, exist_ok=True)
    bench.print_row("row", "work", "bar", "measured", "holds", "of which", "command")
    print("|---|---|---|---|---|---|---|")
    for name, (work, bar, measure) in ROWS.items():
        if not any(fnmatch.fnmatch(name, pattern) for pattern in wanted):
            continue
        ratio, parts, command = measure()
        bench.print_row(name, work, bar, bench.number(ratio), "yes" if holds(ratio, bar) else "no",
                        parts, command)
        sys.stdout.flush()


if __name__ == "__main__":
    main()
