#!/usr/bin/env python3
"""Speed beside other ways to light the same points, in one run, as tables and JSON.

    tests/bench/bench_table.py [FILE.json]        (make bench: build/bench.json)

Every way is a process of its own, and each round has all of them in turn, so that what else the
machine does meets all of them; figures are medians over the rounds, and ratios are of these.

    cached    4 to 256 rays a point that read cached radiance, filtered; by Embree (bench_peers)
    paths     path tracing at every point, by Embree (bench_peers)
    presets, targets, surfaces
              ours: --quality, --max-error, --surface-points (bench_peers)
    cycles    Blender's Cycles on polygons in the discs' place, where it is installed (bench_peers)
    PCV       CloudCompare's plug-in, of the sky that points see, where it is installed

Environment: BUILD (build), SCENES (cornell rooms), POINTS (100000 1000000), WAYS (all of these; cycles
and PCV if they are installed), ROUNDS (3), SECONDS_A_WAY by the clock after which one goes no further
(60), PATHS_A_POINT of the truth (1024), WORK, where scenes are made and kept for the next time
(BUILD/bench).
"""
import json
import os
import platform
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
BUILD = os.path.join(ROOT, os.environ.get("BUILD", "build"))
WORK = os.environ.get("WORK", os.path.join(BUILD, "bench"))
SCENES = os.environ.get("SCENES", "cornell rooms").split()
POINTS = [int(n) for n in os.environ.get("POINTS", "100000 1000000").split()]
ROUNDS = int(os.environ.get("ROUNDS", "3"))
SECONDS = os.environ.get("SECONDS_A_WAY", "60")
PATHS = os.environ.get("PATHS_A_POINT", "1024")

WAYS = os.environ.get("WAYS", "paths cached presets targets surfaces cycles PCV").split()
GOALS = [0.05, 0.03]
# Stages of the report, by what they are for.
PARTS = {
    "surfels": ["surfels"],
    "octree": ["octree"],
    "records": ["direct light", "records", "first gather"],
    "bounces": ["bounces", "read back"],
    "estimate": ["estimate"],
}


def run(command, fine=(0,)):
    """Runs it; its output, seconds, seconds of the processor, and peak memory in bytes of it or of
    what it started, whichever had more. fine: what it may exit with."""
    start = time.monotonic()
    with tempfile.TemporaryFile() as said:
        process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=said, stderr=subprocess.PIPE)
        errors = process.stderr.read()
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        said.seek(0)
        output = said.read().decode()
    if process.returncode not in fine:
        sys.exit(f"bench_table: {' '.join(command)} failed:\n{errors.decode()}")
    return {
        "output": output,
        "seconds": time.monotonic() - start,
        "processor_seconds": used.ru_utime + used.ru_stime,
        "peak_bytes": used.ru_maxrss * 1024,
    }


def tool(name):
    return os.path.join(BUILD, "tests", "bench", name)


def make_scene(kind, points):
    """A scene and its truth, kept for the next time."""
    prefix = os.path.join(WORK, f"{kind}-{points}")
    if not os.path.exists(prefix + ".truth.ply"):
        run([tool("make_truth"), kind, "-o", prefix, "-n", str(points), "-t", "4000", "-p", PATHS])
    return prefix


# ------------------------------------------------------------------------------- seconds to an error


def has_blender():
    return shutil.which("blender") is not None


def climb_command(prefix, way, goal):
    command = [tool("bench_peers"), "--way", way, "--goal", str(goal), "--json"]
    if way == "cycles":
        command += ["--blender", os.path.join(ROOT, "tests", "bench", "peer_cycles.py")]
    return command + [prefix + ".scene.json", prefix + ".truth.ply", SECONDS]


def climb(prefix, way, goal=GOALS[-1]):
    """One way of lighting, as far as it gets."""
    result = run(climb_command(prefix, way, goal))
    rows = [json.loads(line) for line in result["output"].splitlines()]
    return {"rows": rows, "peak_bytes": result["peak_bytes"]}


def reached(climbed, goal):
    """Least seconds of the processor to an error, or None."""
    took = [r["processor_seconds"] for r in climbed["rows"] if r["relative_rms"] <= goal]
    return min(took) if took else None


def median_of(values):
    """None where a round did not get there: whoever gets there by luck does not."""
    return None if not values or None in values else statistics.median(values)


def summary(rounds):
    """Of the rounds of one way."""
    found = {
        f"processor_seconds_to_{int(100 * g)}_percent": median_of([reached(r, g) for r in rounds])
        for g in GOALS
    }
    best = [min((row["relative_rms"] for row in r["rows"]), default=None) for r in rounds]
    found["least_error"] = median_of(best)
    found["peak_bytes"] = statistics.median(r["peak_bytes"] for r in rounds)
    found["rounds"] = rounds
    return found


# ------------------------------------------------------------------------------------------- a bake


def bake_command(prefix, *options):
    """A whole process, which writes the lit points and a report."""
    command = [os.path.join(BUILD, "glowworm"), "bake", prefix + ".scene.json", "-q", "-f"]
    return command + ["-o", prefix + ".lit.ply", "--report", prefix + ".report.json", *options]


def light_again(prefix):
    """A whole process that keeps the transport, and one that begins with it."""
    transport = prefix + ".transport"
    first = run(bake_command(prefix, "--save-transport", transport))
    again = run(bake_command(prefix, "--transport", transport))
    os.remove(transport)
    return first, again


def bake(prefix):
    """A whole process with default settings, then its light anew over the kept transport."""
    whole = run(bake_command(prefix))
    with open(prefix + ".report.json", encoding="utf-8") as file:
        said = json.load(file)
    _, again = light_again(prefix)
    stages = {s["name"]: s["seconds"] for s in said["stages"]}
    return {
        "points": said["points"],
        "seconds": whole["seconds"],
        "processor_seconds": whole["processor_seconds"],
        "peak_bytes": whole["peak_bytes"],
        "error": said["error"]["relative_rms"],
        "second_lighting_processor_seconds": again["processor_seconds"],
        "microseconds_a_point": {
            part: 1e6 * sum(stages.get(n, 0) for n in names) / said["points"]
            for part, names in PARTS.items()
        },
    }


def medians(rounds):
    """The same with the median of each number."""
    first = rounds[0]
    return {
        key: medians([r[key] for r in rounds])
        if isinstance(first[key], dict)
        else statistics.median(r[key] for r in rounds)
        for key in first
    }


# ---------------------------------------------------------------------------------------------- PCV


def has_pcv():
    return "PCV" in WAYS and shutil.which("CloudCompare") is not None and shutil.which("xvfb-run") is not None


def share_of_sky(prefix, program):
    """256 directions of sky that every point sees: CloudCompare's plug-in, or ours without
    reflections. Both are whole processes that read and write PLY."""
    if program == "ours":
        options = ["--light", "sky radiance 1", "--bounces", "0", "--rays", "256"]
        options += ["--estimate-points", "0", "-q", "-f", "-o", prefix + ".sky.ply"]
        return run([os.path.join(BUILD, "glowworm"), "bake", prefix + ".ply"] + options)
    with tempfile.TemporaryDirectory(dir=WORK) as folder:
        cloud = os.path.join(folder, "cloud.ply")
        os.symlink(os.path.abspath(prefix + ".ply"), cloud)
        command = ["xvfb-run", "-a", "CloudCompare", "-SILENT", "-AUTO_SAVE", "OFF", "-O", cloud]
        return run(command + ["-PCV", "-N_RAYS", "256", "-C_EXPORT_FMT", "PLY", "-SAVE_CLOUDS"])


# ------------------------------------------------------------------------------------------- tables


def number(value, unit=1.0):
    return "-" if value is None else f"{value / unit:.3g}"


def ratio(other, ours):
    return "-" if other is None or not ours else f"{other / ours:.2g}"


def print_row(*cells):
    print("| " + " | ".join(str(c) for c in cells) + " |")


def print_ways(scene, ways):
    for way, found in ways.items():
        cells = []
        for goal in GOALS:
            key = f"processor_seconds_to_{int(100 * goal)}_percent"
            cached = ways["cached"][key] if "cached" in ways else None
            cells += [number(found[key]), ratio(cached, found[key])]
        print_row(scene, way, *cells, number(found["least_error"], 0.01),
                  number(found["peak_bytes"], 1e6))


def print_tables(result):
    print("\nSeconds of the processor from bare points until the light is 5 % and 3 % off, how many")
    print("times as long cached radiance takes, the least error reached in", SECONDS, "s by the clock, and")
    print("peak memory of the process.\n")
    print_row("scene", "way", "5 %, s", "cached / it", "3 %, s", "cached / it", "least, %",
              "memory, MB")
    print("|---|---|---|---|---|---|---|---|")
    for scene, found in result["scenes"].items():
        print_ways(scene, found["ways"])
    print("\nA bake with default settings, files and estimate included.\n")
    parts = list(PARTS)
    print_row("scene", "processor, s", "memory, MB", "bytes a point", "stated, %", "second light, s",
              *[f"{p}, us a point" for p in parts])
    print("|" + "---|" * (6 + len(parts)))
    for scene, found in result["scenes"].items():
        b = found["bake"]
        print_row(scene, number(b["processor_seconds"]), number(b["peak_bytes"], 1e6),
                  number(b["peak_bytes"], b["points"]), number(b["error"], 0.01),
                  number(b["second_lighting_processor_seconds"]),
                  *[number(b["microseconds_a_point"][p]) for p in parts])
    if "cycles" in WAYS and not has_blender():
        print("\nBlender is not installed: Cycles is left out.")
    if "PCV" not in WAYS:
        return
    if not has_pcv():
        print("\nCloudCompare or xvfb-run is not installed: its share of sky is left out.")
        return
    print("\nThe share of sky that every point sees, by 256 directions: CloudCompare's PCV, which draws")
    print("the points from each, and ours, irradiance by a sky without reflections.\n")
    print_row("scene", "PCV, s", "ours, s", "PCV / ours", "PCV, MB", "ours, MB")
    print("|---|---|---|---|---|---|")
    for scene, found in result["scenes"].items():
        pcv, ours = found["sky"]["PCV"], found["sky"]["ours"]
        print_row(scene, number(pcv["processor_seconds"]), number(ours["processor_seconds"]),
                  ratio(pcv["processor_seconds"], ours["processor_seconds"]),
                  number(pcv["peak_bytes"], 1e6), number(ours["peak_bytes"], 1e6))


# ------------------------------------------------------------------------------------------- all of it


def measure(prefix):
    """All ways in turn, so many rounds."""
    climbed = {way: [] for way in WAYS if way != "PCV" and (way != "cycles" or has_blender())}
    bakes, skies = [], {"PCV": [], "ours": []}
    for _ in range(ROUNDS):
        for way in climbed:
            climbed[way].append(climb(prefix, way))
        bakes.append(bake(prefix))
        for program in skies if has_pcv() else []:
            found = share_of_sky(prefix, program)
            skies[program].append({k: v for k, v in found.items() if k != "output"})
    return {
        "ways": {way: summary(rounds) for way, rounds in climbed.items()},
        "bake": medians(bakes),
        "sky": {program: medians(rounds) for program, rounds in skies.items() if rounds},
    }


def processor():
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as file:
            return next(l.split(":", 1)[1].strip() for l in file if l.startswith("model name"))
    except (OSError, StopIteration):
        return platform.machine()


def main():
    path = sys.argv[1] if len(sys.argv) > 1 else os.path.join(BUILD, "bench.json")
    os.makedirs(WORK, exist_ok=True)
    version = run([os.path.join(BUILD, "glowworm"), "--version"])["output"].splitlines()[0]
    result = {
        "program": version,
        "processor": processor(),
        "processors": len(os.sched_getaffinity(0)),
        "rounds": ROUNDS,
        "scenes": {},
    }
    for points in POINTS:
        for kind in SCENES:
            result["scenes"][f"{kind}-{points}"] = measure(make_scene(kind, points))
    with open(path + ".new", "w", encoding="utf-8") as file:
        json.dump(result, file, indent=1)
    os.replace(path + ".new", path)
    print(f"{version} on {result['processors']} of {result['processor']}; medians of {ROUNDS}")
    print_tables(result)


if __name__ == "__main__":
    main()
