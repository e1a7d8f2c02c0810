"""A white sphere in the light of a panorama: says where it is brightest, and fails if that is not where the sun stands."""

import math
import pathlib
import sys

import bpy
from mathutils import Vector

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "examples"))
from blender_sky import light_world_with  # noqa: E402

SIDE = 96
TOLERANCE_DEG = 6.0

sky, elevation, azimuth, output = sys.argv[1], float(sys.argv[2]), float(sys.argv[3]), sys.argv[4]
bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
light_world_with(sky)
bpy.ops.mesh.primitive_uv_sphere_add(segments=128, ring_count=64, radius=1.0)
bpy.ops.object.shade_smooth()
white = bpy.data.materials.new("White")
white.use_nodes = True
nodes = white.node_tree.nodes
nodes.clear()
diffuse, surface = nodes.new("ShaderNodeBsdfDiffuse"), nodes.new("ShaderNodeOutputMaterial")
diffuse.inputs["Color"].default_value = (0.8, 0.8, 0.8, 1.0)
white.node_tree.links.new(diffuse.outputs["BSDF"], surface.inputs["Surface"])
bpy.context.object.data.materials.append(white)

# The camera looks from the sun's side, half way up, so that the brightest point is in view and not in the middle.
towards = math.radians(azimuth + 30.0)
place = (10.0 * math.sin(towards), 10.0 * math.cos(towards), 3.0)
bpy.ops.object.camera_add(location=place)
camera = bpy.context.object
aim = camera.constraints.new("TRACK_TO")
bpy.ops.object.empty_add(location=(0.0, 0.0, 0.0))
aim.target = bpy.context.object
camera.data.type = "ORTHO"
camera.data.ortho_scale = 2.2
scene.camera = camera
scene.render.engine = "CYCLES"
scene.cycles.device = "CPU"
scene.cycles.samples = 256
scene.cycles.use_denoising = False
scene.render.resolution_x = scene.render.resolution_y = SIDE
scene.render.resolution_percentage = 100
scene.render.image_settings.file_format = "OPEN_EXR"
scene.render.filepath = output
bpy.ops.render.render(write_still=True)

rendered = bpy.data.images.load(output)
pixels = list(rendered.pixels)
matrix = camera.matrix_world
light = [0.0, 0.0, 0.0]
for y in range(SIDE):
    for x in range(SIDE):
        u, v = ((x + 0.5) / SIDE - 0.5) * 2.2, ((y + 0.5) / SIDE - 0.5) * 2.2
        if u * u + v * v > 0.95:
            continue
        normal = matrix.to_3x3() @ Vector((u, v, math.sqrt(1.0 - u * u - v * v)))
        at = 4 * (y * SIDE + x)
        # What the sun adds stands out against the sky's even light by its power.
        bright = (pixels[at] * 0.2126 + pixels[at + 1] * 0.7152 + pixels[at + 2] * 0.0722) ** 24
        light = [sum_ + bright * part for sum_, part in zip(light, normal)]
length = math.sqrt(sum(part * part for part in light))
east, north, up = (part / length for part in light)
seen = math.degrees(math.asin(up)), math.degrees(math.atan2(east, north)) % 360.0
wanted = [math.radians(elevation), math.radians(azimuth)]
sun = (
    math.cos(wanted[0]) * math.sin(wanted[1]),
    math.cos(wanted[0]) * math.cos(wanted[1]),
    math.sin(wanted[0]),
)
off = math.degrees(math.acos(max(-1.0, min(1.0, east * sun[0] + north * sun[1] + up * sun[2]))))
print(f"sun at {elevation}, {azimuth}: brightest at {seen[0]:.1f}, {seen[1]:.1f}, {off:.1f} degrees off")
sys.exit(0 if off < TOLERANCE_DEG else 1)
