#include "cw2-bake/obj/chunk.h"

#include <algorithm>

namespace bake {

void add_note(std::vector<ObjNote>& notes, const ObjNote& note) {
    const auto same = std::ranges::find(notes, note.kind, &ObjNote::kind);
    if (same == notes.end()) {
        notes.push_back(note);
    } else {
        same->count += note.count;
    }
}

void ObjChunk::clear() {
    positions.clear();
    uvs.clear();
    normals.clear();
    triangles.clear();
    polygons.clear();
    material_uses.clear();
    smoothing_uses.clear();
    libraries.clear();
    notes.clear();
    colors.clear();
    polypaint.clear();
    bad_element = {};
    bad_index = {};
    max_index = {};
    text_bytes = {};
    line_count = 0;
    has_relative = false;
    has_invalid = false;
    has_zero_normal = false;
    lacks_normals = false;
    error.reset();
}

}  // namespace bake
