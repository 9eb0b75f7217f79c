#!/usr/bin/env bash
# Checks who includes whom, that each folder includes only those below it, and that Vulkan objects
# are destroyed in one header only.
# Usage: check_includes.sh [ROOT OF THE REPOSITORY]. Prints PATH:LINE: what is wrong, exits 1.
set -euo pipefail
cd "${1:-$(dirname "$0")/..}"
set -f

# The folders of each program from the lowest to the highest; the program's own files stand above.
layers='
cw2-bake | base textures geometry obj gltf
cw2      | vulkan render options window
'

# files | what they may include besides the standard library, POSIX and, within a program, files of
# their own folder and of lower ones
rules='
common/*                | common/*
common/encode_png.*     | zlib.h
mesh-format/*           | mesh-format/*
mesh-format/tangent_frame.cpp | common/every_cpu.h
mesh-format/frame_rotation.h | common/every_cpu.h
mesh-format/surface.cpp | common/every_cpu.h
mesh-format/decode.cpp  | zstd.h
cw2-bake/*              | common/* mesh-format/* glm/* fmt/* tbb/* CLI/* meshoptimizer.h zstd.h xxhash.h
cw2-bake/inspection.cpp | nlohmann/json.hpp
cw2-bake/obj/*          | fast_float/* emmintrin.h
cw2-bake/gltf/*         | tiny_gltf.h nlohmann/json.hpp
cw2-bake/gltf/draco_reader.cpp | draco/*
cw2-bake/textures/*     | png.h jpeglib.h jerror.h OpenImageIO/*
cw2/*                   | common/* mesh-format/* shaders/interop.h shaders/false_color.h glm/* fmt/* tbb/* vulkan/*
cw2/render/*            | *.vert.h *.frag.h *.comp.h glslang/* SPIRV/* Imf*.h
cw2/options/*           | CLI/* toml++/toml.h
cw2/window/*            | GLFW/* imgui.h backends/imgui_impl_*
shaders/*               | common/srgb.h mesh-format/* shaders/*
shaders/*.h             | glm/*
'
standard='^([a-z0-9_]+|(dirent|dlfcn|fcntl|fnmatch|malloc|poll|pty|termios|unistd|wctype)\.h|sys/[a-z]+\.h)$'
status=0

# The place of a file of a program among the program's layers, from 0; fails for other files.
layer_of() {
    local path=$1 program folders folder place=0
    while IFS='|' read -r program folders; do
        program=${program%% *}
        [[ -n $program && $path == "$program"/* ]] || continue
        for folder in $folders; do
            [[ $path != "$program/$folder"/* ]] || { echo "$place" && return; }
            place=$((place + 1))
        done
        [[ $path != "$program"/*/* ]] || { echo "$path: its folder has no layer" >&2 && return 1; }
        echo "$place" && return
    done <<<"$layers"
    return 1
}

# Whether the file `path` may include `header`.
allowed() {
    local path=$1 header=$2 files headers pattern own theirs
    [[ ! $header =~ $standard ]] || return 0
    if [[ ${path%%/*} == "${header%%/*}" ]] && own=$(layer_of "$path"); then
        theirs=$(layer_of "$header") && [[ $theirs -le $own ]] && return 0
        return 1
    fi
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

includes=$(grep -rnE '^[[:space:]]*#[[:space:]]*include[[:space:]]*["<]' \
    common mesh-format cw2-bake cw2 shaders)
while IFS=: read -r path line text; do
    header=${text#*[\"<]}
    header=${header%%[\">]*}
    allowed "$path" "$header" || { echo "$path:$line: may not include $header" && status=1; }
done <<<"$includes"

destroys=$(grep -rnE '\bvkDestroy[A-Z]' cw2 --include='*.cpp' --include='*.h' --exclude=handle.h) || true
while IFS=: read -r path line text; do
    echo "$path:$line: only cw2/vulkan/handle.h may destroy: ${text#"${text%%[! ]*}"}" && status=1
done < <([[ -z $destroys ]] || echo "$destroys")
exit $status
