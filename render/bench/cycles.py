"""Run by `blender -b --factory-startup -P cycles.py -- job.json`: builds the scene of the job and renders it with
doubling numbers of samples. Writes one EXR file a render, and a line of JSON about it to points.jsonl."""
import array
import json
import os
import resource
import sys
import time

import bpy
from mathutils import Matrix

folder = os.path.dirname(sys.argv[-1])
with open(sys.argv[-1]) as file:
    job = json.load(file)


def path(name):
    return os.path.join(folder, name)


def read(name, kind):
    values = array.array(kind)
    with open(path(name), "rb") as file:
        values.frombytes(file.read())
    return values


for item in list(bpy.data.objects):
    bpy.data.objects.remove(item)
scene = bpy.context.scene


def shader(nodes, links, side):
    """What one side reflects and emits."""
    if side["kind"] == "diffuse":
        node = nodes.new("ShaderNodeBsdfDiffuse")
        node.inputs["Roughness"].default_value = 0.0
    elif side["kind"] == "mirror":
        node = nodes.new("ShaderNodeBsdfGlossy")
        node.distribution = "SHARP"
    else:
        node = nodes.new("ShaderNodeBsdfGlass")
        node.distribution = "SHARP"
        node.inputs["IOR"].default_value = side["ior"]
    node.inputs["Color"].default_value = side["color"] + [1.0]
    if not any(side["radiance"]):
        return node.outputs[0]
    light = nodes.new("ShaderNodeEmission")
    strength = max(side["radiance"])
    light.inputs["Color"].default_value = [c / strength for c in side["radiance"]] + [1.0]
    light.inputs["Strength"].default_value = strength
    both = nodes.new("ShaderNodeAddShader")
    links.new(node.outputs[0], both.inputs[0])
    links.new(light.outputs[0], both.inputs[1])
    return both.outputs[0]


def material(sides):
    made = bpy.data.materials.new("material")
    made.use_nodes = True
    nodes, links = made.node_tree.nodes, made.node_tree.links
    nodes.clear()
    output = nodes.new("ShaderNodeOutputMaterial")
    front = shader(nodes, links, sides[0])
    if sides[0] == sides[1] or sides[0]["kind"] == "glass":
        links.new(front, output.inputs["Surface"])
        return made
    mix, geometry = nodes.new("ShaderNodeMixShader"), nodes.new("ShaderNodeNewGeometry")
    links.new(geometry.outputs["Backfacing"], mix.inputs[0])
    links.new(front, mix.inputs[1])
    links.new(shader(nodes, links, sides[1]), mix.inputs[2])
    links.new(mix.outputs[0], output.inputs["Surface"])
    return made


positions, triangles = read("positions", "f"), read("triangles", "I")
for number, shape in enumerate(job["shapes"]):
    first, last = shape["positions"]
    points = [positions[3 * i:3 * i + 3] for i in range(first, last)]
    first, last = shape["triangles"]
    faces = [tuple(triangles[3 * i:3 * i + 3]) for i in range(first, last)]
    mesh = bpy.data.meshes.new("shape%d" % number)
    mesh.from_pydata(points, [], faces)
    mesh.materials.append(material(shape["sides"]))
    scene.collection.objects.link(bpy.data.objects.new("shape%d" % number, mesh))

camera = bpy.data.cameras.new("camera")
camera.sensor_fit = "HORIZONTAL"
camera.angle_x = job["camera"]["fov_x"]
camera.clip_start, camera.clip_end = job["camera"]["clip"]
seen = bpy.data.objects.new("camera", camera)
seen.matrix_world = Matrix(job["camera"]["matrix"])
scene.collection.objects.link(seen)
scene.camera = seen

world = bpy.data.worlds.new("world")
world.use_nodes = True
background = world.node_tree.nodes["Background"]
background.inputs["Color"].default_value = job["sky"] + [1.0]
background.inputs["Strength"].default_value = 1.0
scene.world = world

render, cycles = scene.render, scene.cycles
render.engine = "CYCLES"
render.resolution_x, render.resolution_y, render.resolution_percentage = job["width"], job["height"], 100
render.threads_mode, render.threads = "FIXED", job["threads"]
render.use_persistent_data = False
image = render.image_settings
image.file_format, image.color_mode, image.color_depth, image.exr_codec = "OPEN_EXR", "RGB", "32", "ZIP"
cycles.device = "CPU"
cycles.use_denoising = False
cycles.use_adaptive_sampling = False
cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
cycles.light_sampling_threshold = 0.0
cycles.blur_glossy = 0.0
cycles.caustics_reflective = cycles.caustics_refractive = True
cycles.pixel_filter_type, cycles.filter_width = "BOX", 1.0
for name in ("max_bounces", "diffuse_bounces", "glossy_bounces", "transmission_bounces", "transparent_max_bounces"):
    setattr(cycles, name, job["bounces"])

last = 0
with open(path("points.jsonl"), "w") as points:
    for seed in range(job["seeds"]):
        cycles.seed = seed
        begin = time.time()
        samples = 1
        while True:
            cycles.samples = samples
            name = "picture-%d-%d.exr" % (seed, samples)
            render.filepath = path(name)
            wall, cpu = time.time(), time.process_time()
            bpy.ops.render.render(write_still=True)
            points.write(json.dumps({
                "seed": seed, "spp": samples, "file": name, "seconds": time.time() - wall,
                "cpu_seconds": time.process_time() - cpu, "version": bpy.app.version_string,
                "memory_bytes": 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss}) + "\n")
            points.flush()
            # Each number of samples is a render of its own: the next takes twice as long as the last alone.
            spent = time.time() - begin
            if samples == last or (seed == 0 and spent + 2.0 * (time.time() - wall) > job["seconds"]):
                break
            samples *= 2
        if seed == 0:
            last = samples
