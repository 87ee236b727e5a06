#!/bin/sh
# Where the time goes: tests/bench/profile.sh [SCENE [SIZE [SPP]]]
# Pass one alone, then each integrator on its solution, one thread, sampled by perf (Debian's linux-perf). Code counts
# where the compiler put it: what is inlined belongs to its caller.
set -eu
cd "$(dirname "$0")/../.."
scene=${1:-scenes/cornell-box/scene.xml}
size=${2:-256x256}
spp=${3:-64}
program=build/release/twopass
command -v perf >/dev/null || { echo "profile.sh: perf is not there; apt-get install linux-perf" >&2; exit 1; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

# Shares of a recording by what the code is for.
shares() {
  perf report -i "$1" --no-children --stdio --sort dso,symbol 2>/dev/null | awk '
    /^#/ || NF < 4 { next }
    {
      share = $1 + 0
      if ($2 ~ /libembree/) what = "traversal (Embree)"
      else if ($2 ~ /kernel/) what = "system"
      else if ($0 ~ /Embree|RayCaster|in_order|finish<|Rays</) what = "rays into packets and out"
      else if ($0 ~ /Eigen|Balance|row_sums|contraction|exchange|enforce|introsort/) what = "radiosity: equations"
      else if ($0 ~ /LampInView|form_factor|certain|Certain|VisiblePart|Lambert|accurate_cross|atan2/) what = "light in closed form"
      else if ($0 ~ /Guide|guide|Guided/) what = "guide"
      else if ($0 ~ /IndirectField|Solution|Element|VertexMesh|triangle_cell|triangle_patch|Patch::|irradiance|Survey|landing|Landing|SpecularPath|is_covered|visible_fraction|smooth/) what = "radiosity: elements and look-ups"
      else if ($0 ~ /Sampler|sobol|owen|hash/) what = "random numbers"
      else if ($0 ~ /Light|Environment|Polygon|polygon|integrand_over/) what = "lights"
      else if ($0 ~ /Textur|texel|Bitmap|Level/) what = "textures"
      else if ($0 ~ /Bsdf|bsdf|Material|Microfacet|Principled|Plastic|Conductor|Dielectric|Diffuse|Phong|Ward|fresnel|Fresnel|lobe|Lobe|visit_invoke/) what = "materials"
      else if ($0 ~ /surface_point|SurfacePoint|Mesh/) what = "surface points"
      else if ($0 ~ /Film|Camera|render_tile|Pixel|Filter/) what = "camera and film"
      else if ($0 ~ /trace_bundles|Vertex|Unbiased|TwoPass/) what = "paths: vertices, stages"
      else what = "everything else"
      sum[what] += share
    }
    END { for (what in sum) printf "%6.1f %%  %s\n", sum[what], what }' | sort -rn
}

record() {  # record TITLE command ...
  title=$1
  shift
  perf record -q -e cpu-clock -F 999 -o "$folder/perf" "$@" >/dev/null 2>&1
  echo "$title"
  shares "$folder/perf"
}

record "pass one" $program solve "$scene" --threads 1 -o "$folder/s.radiosity"
for integrator in path twopass unbiased; do
  with=
  [ $integrator = path ] || with="--solution $folder/s.radiosity --no-certificate"
  record "$integrator" $program render "$scene" --integrator $integrator --size "$size" --spp "$spp" --threads 1 $with \
    -o "$folder/a.exr"
done
