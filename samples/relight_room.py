#!/usr/bin/env python3
"""relight_room.py - relight_room.c in Python: ctypes and numpy, nothing to build.

The library is found as any other, or is what GLOWWORM_LIBRARY names.
"""
import ctypes as c
import math
import os
import sys

import numpy

POINTS, SIDE, FRAMES = 60000, 3.0, 8


class Points(c.Structure):  # gw_points
    _fields_ = [("count", c.c_size_t), ("position", c.c_void_p), ("normal", c.c_void_p),
                ("albedo", c.c_void_p), ("emission", c.c_void_p), ("opacity", c.c_void_p),
                ("scanner", c.c_void_p),
                ("scanner_count", c.c_size_t), ("scanner_of", c.c_void_p),
                ("image", c.c_void_p), ("image_count", c.c_size_t), ("image_cell", c.c_void_p),
                ("own_area", c.c_void_p), ("beam_share", c.c_void_p), ("stray", c.c_void_p),
                ("keep_strays", c.c_bool), ("up", c.c_char),
                ("normal_sideless", c.c_bool), ("instance", c.c_void_p),
                ("instance_count", c.c_size_t)]


class Light(c.Structure):  # gw_light
    _fields_ = [("type", c.c_int), ("name", c.c_char * 64), ("position", c.c_double * 3),
                ("direction", c.c_double * 3), ("intensity", c.c_float * 3),
                ("irradiance", c.c_float * 3), ("radiance", c.c_float * 3),
                ("inner_angle", c.c_float), ("outer_angle", c.c_float), ("radius", c.c_float),
                ("angle", c.c_float), ("map", c.c_void_p), ("map_width", c.c_uint32),
                ("map_height", c.c_uint32), ("rotation", c.c_float), ("map_y_up", c.c_bool),
                ("distribution", c.c_void_p), ("vertical_count", c.c_uint32),
                ("horizontal_count", c.c_uint32), ("across", c.c_double * 3),
                ("size", c.c_float * 2)]


class SceneDescription(c.Structure):  # gw_scene_description
    _fields_ = [("points", c.POINTER(Points)), ("lights", c.POINTER(Light)),
                ("light_count", c.c_size_t)]


class Error(c.Structure):  # gw_error
    _fields_ = [("status", c.c_int), ("text", c.c_char * 1024)]


class Estimate(c.Structure):  # gw_error_estimate
    _fields_ = [("points", c.c_uint32), ("relative_rms", c.c_double), ("gathered", c.c_double),
                ("spread", c.c_double), ("bias", c.c_double), ("noise", c.c_double),
                ("shadows", c.c_double), ("normals", c.c_double), ("emission", c.c_double),
                ("geometry", c.c_double), ("gaps", c.c_double), ("sides", c.c_double),
                ("sides_share", c.c_double), ("narrow", c.c_double),
                ("between", c.c_double), ("halves", c.c_double)]


library = c.CDLL(os.environ.get("GLOWWORM_LIBRARY", "libglowworm.so.0.1"))
error = Error()


def call(name, *arguments):
    """Calls a function of the library whose last parameter is a gw_error."""
    if getattr(library, name)(*arguments, c.byref(error)) != 0:
        sys.exit("relight_room.py: " + error.text.decode())


def make_room():
    """Points spread evenly over six walls, the floor being every sixth from the fifth on."""
    i = numpy.arange(POINTS)
    axis, sign = i % 6 // 2, i % 2
    u, v = i * 0.7548776662466927, i * 0.5698402909980532
    position, normal = numpy.zeros((POINTS, 3)), numpy.zeros((POINTS, 3), numpy.float32)
    position[i, axis] = SIDE * sign
    position[i, (axis + 1) % 3] = SIDE * (u - numpy.floor(u))
    position[i, (axis + 2) % 3] = SIDE * (v - numpy.floor(v))
    normal[i, axis] = 1 - 2 * sign
    return position, normal


position, normal = make_room()
radiance = numpy.empty((POINTS, 3), numpy.float32)
points = Points(count=POINTS, position=position.ctypes.data, normal=normal.ctypes.data)
lamp = Light(type=0, intensity=(10.0, 10.0, 10.0))
scene, lighting = c.c_void_p(), c.c_void_p()
room = SceneDescription(points=c.pointer(points))
call("gw_scene_create", c.byref(room), None, None, c.byref(scene))
for i in range(FRAMES):
    turn = 2.0 * math.pi * i / FRAMES
    lamp.position[:] = 1.5 + math.cos(turn), 1.5 + math.sin(turn), 0.6 + 0.25 * i
    if lighting:
        call("gw_lighting_change", lighting, c.byref(lamp), c.c_size_t(1))
    else:
        call("gw_lighting_create", scene, c.byref(lamp), c.c_size_t(1), c.byref(lighting))
    call("gw_lighting_radiance", lighting, radiance.ctypes.data_as(c.c_void_p))
    print("lamp at %.2f %.2f %.2f: mean %.3f, floor %.3f" %
          (*lamp.position, radiance[:, 0].mean(dtype=float), radiance[4::6, 0].mean(dtype=float)))
estimate = Estimate()
call("gw_lighting_error", lighting, c.byref(estimate))
print("estimated error of the last one: %.2f %%" % (100.0 * estimate.relative_rms))
library.gw_lighting_destroy(c.byref(lighting))
library.gw_scene_destroy(c.byref(scene))
