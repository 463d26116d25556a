# Run inside Blender by peer_cycles.c, which says what the files hold: lights the polygons by Cycles.
#
#   blender -b --factory-startup --python peer_cycles.py -- SCENE.json POLYGONS LIGHT SAMPLES
#
# One mesh has the polygons, whose fronts reflect and emit and whose backs are black. What Cycles bakes is
# another, a small white triangle above each of their middles, which no ray but the bake's own meets:
# each has one pixel of a picture, which receives the light that comes to it. To corners of polygons a bake
# is as right, but each corner is lit by itself, three of a triangle at least.
import json
import math
import sys
import time

import bpy
import numpy

scene_file, polygons_file, light_file, samples = sys.argv[sys.argv.index("--") + 1:]

# Corners of the small triangles: about their middle in spacings, and in the picture in pixels.
SMALL = 0.05
TURN = [math.radians(10 + 120 * k) for k in range(3)]


def read_polygons(path):
    """Arrays by name, and the header's numbers."""
    with open(path, "rb") as file:
        count, corners = numpy.fromfile(file, numpy.uint64, 2).tolist()
        origin, above, spacing = numpy.split(numpy.fromfile(file, numpy.float64, 5), [3, 4])
        found = {"count": count, "origin": origin, "above": above[0], "spacing": spacing[0]}
        found["corner"] = numpy.fromfile(file, numpy.float32, 3 * corners)
        found["corners"] = numpy.fromfile(file, numpy.uint32, count).astype(numpy.int32)
        for name in ("position", "normal", "albedo", "emission"):
            found[name] = numpy.fromfile(file, numpy.float32, 3 * count).reshape(count, 3)
    return found


def add_mesh(name, corner, corners):
    """A mesh of polygons that share no corners, as an object of the scene."""
    mesh = bpy.data.meshes.new(name)
    total = int(corners.sum())
    mesh.vertices.add(total)
    mesh.vertices.foreach_set("co", corner)
    mesh.loops.add(total)
    mesh.loops.foreach_set("vertex_index", numpy.arange(total, dtype=numpy.int32))
    mesh.polygons.add(len(corners))
    mesh.polygons.foreach_set("loop_start", (numpy.cumsum(corners) - corners).astype(numpy.int32))
    mesh.polygons.foreach_set("loop_total", corners)
    mesh.update()
    thing = bpy.data.objects.new(name, mesh)
    bpy.context.collection.objects.link(thing)
    return thing


def add_material(mesh, emits):
    """Diffuse as the attribute `albedo` says, and shining as `emission` does; backs are black."""
    material = bpy.data.materials.new("surface")
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()

    def value(name):
        node = tree.nodes.new("ShaderNodeAttribute")
        node.attribute_name = name
        return node.outputs["Vector"]

    shader = tree.nodes.new("ShaderNodeBsdfDiffuse")
    tree.links.new(value("albedo"), shader.inputs["Color"])
    if emits:
        glow, both = tree.nodes.new("ShaderNodeEmission"), tree.nodes.new("ShaderNodeAddShader")
        tree.links.new(value("emission"), glow.inputs["Color"])
        tree.links.new(shader.outputs[0], both.inputs[0])
        tree.links.new(glow.outputs[0], both.inputs[1])
        shader = both
    side = tree.nodes.new("ShaderNodeMixShader")
    tree.links.new(tree.nodes.new("ShaderNodeNewGeometry").outputs["Backfacing"], side.inputs[0])
    tree.links.new(shader.outputs[0], side.inputs[1])
    tree.links.new(side.outputs[0], tree.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
    mesh.materials.append(material)


def add_surface(found):
    there = found["corners"] > 0
    mesh = add_mesh("surface", found["corner"], found["corners"][there]).data
    for name in ("albedo", "emission"):
        values = mesh.attributes.new(name, "FLOAT_VECTOR", "FACE").data
        values.foreach_set("vector", found[name][there].ravel())
    # Cycles aims at all that a material which emits is on.
    add_material(mesh, False)
    add_material(mesh, True)
    emits = (found["emission"][there] > 0).any(axis=1)
    mesh.polygons.foreach_set("material_index", emits.astype(numpy.int32))


def add_meters(found, width):
    """Small triangles, each with a pixel of a picture of this width; the picture."""
    position = found["position"] + numpy.float32(found["above"]) * found["normal"]
    helper = numpy.where(numpy.abs(found["normal"][:, :1]) < 0.7, [[1.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]])
    x = numpy.cross(helper, found["normal"])
    x /= numpy.linalg.norm(x, axis=1, keepdims=True)
    y = numpy.cross(found["normal"], x)
    size = SMALL * found["spacing"]
    corner = [position + size * (math.cos(t) * x + math.sin(t) * y) for t in TURN]
    corner = numpy.stack(corner, axis=1).astype(numpy.float32).ravel()
    meters = add_mesh("meters", corner, numpy.full(found["count"], 3, numpy.int32))
    pixel = numpy.arange(found["count"])
    u, v = pixel % width + 0.5, pixel // width + 0.5
    uv = [numpy.stack([u + 0.49 * math.cos(t), v + 0.49 * math.sin(t)], axis=1) for t in TURN]
    uv = (numpy.stack(uv, axis=1) / width).astype(numpy.float32)
    meters.data.uv_layers.new().data.foreach_set("uv", uv.ravel())
    for kind in ("diffuse", "glossy", "transmission", "volume_scatter", "shadow"):
        setattr(meters, "visible_" + kind, False)
    return meters, add_picture(meters.data, width)


def add_picture(mesh, width):
    """A white material with a picture to bake to; the picture."""
    material = bpy.data.materials.new("meter")
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    white = tree.nodes.new("ShaderNodeBsdfDiffuse")
    white.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    tree.links.new(white.outputs[0], tree.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
    picture = bpy.data.images.new("light", width, width, float_buffer=True, is_data=True)
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = picture
    tree.nodes.active = node
    mesh.materials.append(material)
    return picture


def add_lamps(path, origin):
    """Of the kinds that scenes of known light have. A lamp of Blender's sends a 4 pi-th of its watts each way."""
    with open(path, encoding="utf-8") as file:
        lamps = json.load(file)["lights"]
    sky = numpy.zeros(3)
    for lamp in lamps:
        kind = {"point": "POINT", "sun": "SUN"}.get(lamp["type"])
        if lamp["type"] == "environment":
            sky += lamp["radiance"]
            continue
        if not kind:
            sys.exit(f"peer_cycles: no lamps of type {lamp['type']}")
        light = bpy.data.lights.new(kind, kind)
        color = numpy.array(lamp["intensity"] if kind == "POINT" else lamp["irradiance"])
        light.color, light.energy = color / color.max(), color.max()
        thing = bpy.data.objects.new(kind, light)
        bpy.context.collection.objects.link(thing)
        if kind == "POINT":
            light.energy *= 4 * math.pi
            light.shadow_soft_size = lamp.get("radius", 0.0)
            thing.location = numpy.array(lamp["position"]) - origin
        else:
            from mathutils import Vector
            light.angle = math.radians(lamp.get("angle", 0.0))
            thing.rotation_mode = "QUATERNION"
            thing.rotation_quaternion = Vector(lamp["direction"]).to_track_quat("-Z", "Y")
    world = bpy.data.worlds.new("sky")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (*sky, 1.0)
    bpy.context.scene.world = world


def settle(scene):
    """All bounces, and nothing that trades noise for an error that stays."""
    scene.render.engine = "CYCLES"
    cycles = scene.cycles
    cycles.samples = int(samples)
    cycles.use_adaptive_sampling = cycles.use_denoising = cycles.use_fast_gi = False
    cycles.max_bounces = cycles.diffuse_bounces = 1024
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    cycles.light_sampling_threshold = cycles.blur_glossy = 0.0


def main():
    found = read_polygons(polygons_file)
    start, busy = time.perf_counter(), time.process_time()
    for thing in list(bpy.data.objects):
        bpy.data.objects.remove(thing)
    width = math.isqrt(found["count"] - 1) + 1
    add_surface(found)
    meters, picture = add_meters(found, width)
    add_lamps(scene_file, found["origin"])
    settle(bpy.context.scene)
    bpy.context.view_layer.objects.active = meters
    meters.select_set(True)
    bpy.ops.object.bake(type="DIFFUSE", pass_filter={"DIRECT", "INDIRECT"}, margin=0, use_clear=True)
    light = numpy.empty(4 * width * width, numpy.float32)
    picture.pixels.foreach_get(light)
    # Of white, what it sends on is a pi-th of what comes.
    light = math.pi * light.reshape(-1, 4)[:found["count"], :3]
    took = [time.perf_counter() - start, time.process_time() - busy]
    with open(light_file, "wb") as file:
        numpy.array(took, numpy.float64).tofile(file)
        light.astype(numpy.float32).tofile(file)


main()
