#!/usr/bin/env bash
# Installs the programs into a folder of their own and uses them there, as people do after
# `cmake --install`. Usage: install_test.sh BUILD_FOLDER WORK_FOLDER
set -euo pipefail
build=$1
work=$2

fail() {
    echo "install_test.sh: $*" >&2
    exit 1
}

rm -rf "$work"
mkdir -p "$work"
cmake --install "$build" --prefix "$work/prefix" >"$work/install.txt"
# Elsewhere than CMake was told, and nothing beside it.
mv "$work/prefix" "$work/moved"
bin=$work/moved/bin
share=$work/moved/share

# A square with a texture, of the demo scene's.
cp "$(find "$build/assets/demo/textures" -name '*.png' | sort | head -n 1)" "$work/texture.png"
printf 'newmtl m\nmap_Kd texture.png\n' >"$work/square.mtl"
printf 'mtllib square.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n' \
    >"$work/square.obj"
cd /
"$bin/cw2-bake" "$work/square.obj" -o "$work/square.cw2mesh" --strict --quiet
XDG_CACHE_HOME=$work/cache "$bin/cw2" "$work/square.obj" --size 64x64 --output "$work/square.png"
[[ $(head -c 4 "$work/square.png" | tail -c 3) == PNG ]] || fail "no picture"

for program in cw2 cw2-bake; do
    "$bin/$program" --version | grep -qE "^$program [0-9]+\.[0-9]+\.[0-9]+ \(" ||
        fail "$program --version says $("$bin/$program" --version)"
    page=$(zcat "$share/man/man1/$program.1.gz" | sed 's/\\-/-/g')
    options=$("$bin/$program" --help | grep -oE '^ *(-[a-z], ?)?--[a-z-]+' | grep -oE -- '--?[a-z-]+')
    [[ $(wc -l <<<"$options") -gt 10 ]] || fail "no options in $program --help"
    for option in $options; do
        grep -qF -- "\\fB$option\\fR" <<<"$page" || fail "$program.1 lacks $option"
        grep -qE -- "[ \"|]$option[ \"|)]" "$share/bash-completion/completions/$program" ||
            fail "bash's completion of $program lacks $option"
        grep -qE -- "[ {,]$option([[},']|$)" "$share/zsh/site-functions/_$program" ||
            fail "zsh's completion of $program lacks $option"
        # -o is " -s o ", --output " -l output ".
        grep -qE -- " -[sl] ${option##*-} | -l ${option#--} " \
            "$share/fish/vendor_completions.d/$program.fish" ||
            fail "fish's completion of $program lacks $option"
    done
done

# What Tab shows behind the words.
complete_in_bash() {
    PATH=$bin:$PATH bash -c '
        . "$1"
        compopt() { :; }
        shift
        COMP_WORDS=("$@") COMP_CWORD=$(($# - 1))
        "_$1"
        echo "${COMPREPLY[*]}"' bash "$share/bash-completion/completions/$1" "$@"
}
expect() {
    local expected=$1
    shift
    [[ $(complete_in_bash "$@") == "$expected" ]] || fail "'$*' becomes '$(complete_in_bash "$@")'"
}
expect "--tangent-frame" cw2-bake --ta
expect "quat32 quat48" cw2-bake a.obj --tangent-frame qu
expect "lossless" cw2-bake --textures = l
expect "shaded" cw2 --view sh
expect "" cw2-bake -o a
for shell in zsh fish; do
    command -v "$shell" >/dev/null || continue
    for file in "$share"/zsh/*/_* "$share"/fish/*/*.fish; do
        [[ $file != */"$shell"/* ]] || "$shell" -n "$file" || fail "$shell does not read $file"
    done
done
if command -v groff >/dev/null; then
    for page in "$share"/man/man1/*; do
        complaints=$(zcat "$page" | groff -man -ww -z 2>&1)
        [[ -z $complaints ]] || fail "$page: $complaints"
    done
fi

# What the window compiles its shaders from.
for shader in mesh.vert opaque.frag alpha_mask.frag emissive.frag; do
    cmp "$share/cw2/shaders/$shader" "$build/share/cw2/shaders/$shader"
    "${GLSLANG:-glslangValidator}" --quiet -V --target-env vulkan1.3 "-I$share/cw2" -o "$work/spirv" \
        "$share/cw2/shaders/$shader"
done
