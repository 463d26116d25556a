#!/usr/bin/env python3
"""lone_thread.py - what one thread of a program does while all others wait, as a table.

  perf record -F 499 -g --call-graph=fp build/frames/glowworm bake ...
  tests/bench/lone_thread.py [perf.data] [LEAST]

Samples of the first thread count that are not within gw_parallel_for, whose share of the work other
threads may take; what it does while a driver's threads work counts too. LEAST is in seconds (0.1).

Stacks need frame pointers:
  make BUILD=build/frames OPT='-O2 -g -fno-omit-frame-pointer -fno-optimize-sibling-calls'
"""
import collections
import re
import subprocess
import sys

DEPTH = 6
SHARED = {"gw_parallel_for", "run_worker", "take_chunks"}
# Frames that stand for no step: the kernel's, those of C and C++, and what all bakes are within.
LEFT_OUT = re.compile(
    r"\[|asm_|exc_|do_|handle_|_|clear_|vma|folio|alloc|pvm|get_page|entry|flann|std::|start_thread|clone"
    r"|main$|run_program|verb_bake|gw_bake|try_surface|bake_in_units|run_steps"
)
HEAD = re.compile(r".*\s(\d+)/(\d+)\s*$")


def frequency(path):
    """Samples a second, as perf was asked for."""
    text = subprocess.run(["perf", "evlist", "-v", "-i", path], capture_output=True, text=True).stdout
    found = re.search(r"sample_freq\D*(\d+)", text)
    if not found:
        sys.exit(f"{path} does not say how often it was sampled; record it by perf record -F")
    return int(found.group(1))


def samples(path):
    """Process, thread and stack, innermost first, of each sample."""
    script = ["perf", "script", "-i", path, "-F", "comm,pid,tid,ip,sym"]
    owner, stack = None, []
    with subprocess.Popen(script, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as perf:
        for line in perf.stdout:
            head = None if line.startswith("\t") else HEAD.match(line)
            if head:
                owner, stack = head.groups(), []
            elif line.strip():
                stack.append(line.split(None, 1)[1].strip().split("+")[0])
            elif owner:
                yield (*owner, stack)
                owner = None
    if owner:
        yield (*owner, stack)


def main():
    path = sys.argv[1] if len(sys.argv) > 1 else "perf.data"
    least = float(sys.argv[2]) if len(sys.argv) > 2 else 0.1
    second = frequency(path)
    steps, alone, everything = collections.Counter(), 0, 0
    for process, thread, stack in samples(path):
        everything += 1
        if process != thread or SHARED.intersection(stack):
            continue
        alone += 1
        own = [frame for frame in reversed(stack) if not LEFT_OUT.match(frame)]
        for depth in range(1, min(DEPTH, len(own)) + 1):
            steps[tuple(own[:depth])] += 1
    print(f"one thread alone {alone / second:.2f} of {everything / second:.2f} processor seconds")
    for step, count in sorted(steps.items()):
        if count / second >= least:
            print(f"{count / second:7.2f} {'  ' * (len(step) - 1)}{step[-1]}")


if __name__ == "__main__":
    main()
