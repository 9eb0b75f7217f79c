#!/usr/bin/env bash
# Checks who includes whom, and that Vulkan objects are destroyed in one header only.
# Usage: check_includes.sh [ROOT OF THE REPOSITORY]. Prints PATH:LINE: what is wrong, exits 1.
set -euo pipefail
cd "${1:-$(dirname "$0")/..}"
set -f

# files | what they may include besides the standard library and POSIX
rules='
mesh-format/*           | mesh-format/*
mesh-format/decode.cpp  | meshoptimizer.h zstd.h fmt/* tbb/*
mesh-format/encode_png.* | png.h
cw2-bake/*              | mesh-format/* cw2-bake/* glm/* fmt/* tbb/* CLI/*
cw2-bake/*              | meshoptimizer.h zstd.h xxhash.h
cw2-bake/read_*.cpp     | fast_float/*
cw2-bake/gltf_*         | tiny_gltf.h nlohmann/json.hpp
cw2-bake/write_gltf.*   | nlohmann/json.hpp
cw2-bake/read_common_*  | png.h jpeglib.h jerror.h
cw2-bake/obj_parser.cpp | fast_float/*
cw2-bake/digits.h       | emmintrin.h
cw2-bake/image_reader.* | OpenImageIO/*
cw2/*                   | mesh-format/* cw2/* shaders/interop.h shaders/false_color.h *.vert.h *.frag.h glm/* fmt/*
cw2/*                   | tbb/* CLI/* vulkan/* glslang/* SPIRV/* Imf*.h
cw2/config.cpp          | toml++/toml.h
cw2/window*             | GLFW/*
cw2/ui_pass.cpp         | imgui.h backends/imgui_impl_*
cw2/panel*.cpp          | imgui.h
shaders/*               | mesh-format/* shaders/*
shaders/*.h             | glm/*
'
standard='^([a-z0-9_]+|(dlfcn|fcntl|malloc|unistd)\.h|sys/[a-z]+\.h)$'
status=0

# Whether the file `path` may include `header`.
allowed() {
    local path=$1 header=$2 files headers pattern
    [[ ! $header =~ $standard ]] || return 0
    while IFS='|' read -r files headers; do
        # shellcheck disable=SC2053 # the table holds patterns
        [[ -n $files && $path == ${files%% *} ]] || continue
        for pattern in $headers; do
            # shellcheck disable=SC2053
            [[ $header != $pattern ]] || return 0
        done
    done <<<"$rules"
    return 1
}

includes=$(grep -rnE '^[[:space:]]*#[[:space:]]*include[[:space:]]*["<]' mesh-format cw2-bake cw2 shaders)
while IFS=: read -r path line text; do
    header=${text#*[\"<]}
    header=${header%%[\">]*}
    allowed "$path" "$header" || { echo "$path:$line: may not include $header" && status=1; }
done <<<"$includes"

destroys=$(grep -rnE '\bvkDestroy[A-Z]' cw2 --include='*.cpp' --include='*.h' --exclude=vk_handle.h) || true
while IFS=: read -r path line text; do
    echo "$path:$line: only cw2/vk_handle.h may destroy: ${text#"${text%%[! ]*}"}" && status=1
done < <([[ -z $destroys ]] || echo "$destroys")
exit $status
