#include <cmath>
#include <fstream>
#include <string>

#include "tests/growth/inputs.h"

namespace {

using std::to_string;
using Path = std::filesystem::path;

const std::string kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

void write(const Path& path, const std::string& text) {
    std::ofstream(path, std::ios::binary) << text;
}

Path write_obj(const Path& folder, const std::string& obj, const std::string& mtl = "newmtl m\n") {
    write(folder / "m.mtl", mtl);
    write(folder / "scene.obj", "mtllib m.mtl\n" + obj);
    return folder / "scene.obj";
}

/// `n` times what `line` makes of a number.
template <typename Line>
std::string lines(int n, Line&& line) {
    std::string text;
    for (int i = 0; i < n; ++i) text += line(i);
    return text;
}

Path unknown_materials(const Path& folder, int n) {
    return write_obj(folder, kTriangle + lines(n, [](int i) {
                                 return "usemtl x" + to_string(i) + "\nf 1 2 3\n";
                             }));
}

Path materials_of(const Path& folder, int n, const std::string& statement) {
    const auto name = [](int i) { return std::string("m").append(to_string(i)); };
    return write_obj(
        folder, kTriangle + lines(n, [&](int i) { return "usemtl " + name(i) + "\nf 1 2 3\n"; }),
        lines(n, [&](int i) {
            return "newmtl " + name(i) + '\n' + statement + to_string(i) + " 3\n";
        }));
}
Path unknown_keywords(const Path& folder, int n) {
    return materials_of(folder, n, "word");
}
Path numbers_out_of_range(const Path& folder, int n) {
    return materials_of(folder, n, "Pr 7");
}
Path unknown_channels(const Path& folder, int n) {
    return materials_of(folder, n, "map_Kd -imfchan x");
}
Path keywords_of_one_material(const Path& folder, int n) {
    return write_obj(folder, kTriangle + "usemtl m\nf 1 2 3\n", "newmtl m\n" + lines(n, [](int i) {
                                                                    return "Pcr 1\nanisor 1\nword" +
                                                                           to_string(i) + " 3\n";
                                                                }));
}

Path unknown_statements(const Path& folder, int n) {
    return write_obj(folder, kTriangle + "f 1 2 3\n" + lines(n, [](int i) {
                                 return "word" + to_string(i) + " 1\ncurv" + to_string(i) + "\n";
                             }));
}
Path bad_references(const Path& folder, int n) {
    return write_obj(folder, kTriangle + lines(n, [](int i) {
                                 return "vt nan 0\nvn 0 0 0\nf 1/1/1 2/999999/" +
                                        to_string(i + 900'000) + " 3\n";
                             }));
}

Path missing_libraries(const Path& folder, int n) {
    return write_obj(folder, kTriangle + "usemtl m\nf 1 2 3\n" + lines(n, [](int i) {
                                 return "mtllib a/b" + to_string(i) + "/c.mtl\n";
                             }));
}
/// One file by many names.
Path one_library(const Path& folder, int n) {
    const auto name = [](int i) {
        std::string text;
        for (int bit = 0; bit < 12; ++bit) text += i >> bit & 1 ? "./" : ".//";
        return text + "m.mtl";
    };
    return write_obj(folder,
                     kTriangle + "usemtl x\nf 1 2 3\n" +
                         lines(n, [&](int i) { return "mtllib " + name(i) + '\n'; }),
                     lines(n, [](int i) { return "newmtl y" + to_string(i) + '\n'; }));
}
Path long_names(const Path& folder, int n) {
    const std::string name = lines(n, [](int) { return "../"; });
    return write_obj(folder, kTriangle + "usemtl m\nf 1 2 3\n",
                     "newmtl m\nmap_Kd " + name + "a.png\n");
}

Path continued_face(const Path& folder, int n) {
    return write_obj(folder, kTriangle + "v 0 0 1\nf" + lines(n, [](int i) {
                                 return ' ' + to_string(i % 4 + 1) + " \\\n";
                             }) + "\n");
}
template <typename Point>
Path polygon(const Path& folder, int n, Point&& point) {
    return write_obj(folder, lines(n,
                                   [&](int i) {
                                       const auto [x, y] = point(i);
                                       return "v " + to_string(x) + ' ' + to_string(y) + " 0\n";
                                   }) +
                                 'f' + lines(n, [](int i) { return ' ' + to_string(i + 1); }));
}
using Point = std::pair<double, double>;
Path comb(const Path& folder, int n) {
    return polygon(folder, n, [&](int i) {
        const int back = n - 1 - i;
        if (i < 2) return Point(i * n, -10.0);
        return Point(back + 0.2 * (back % 2), back / 2 % 2 * (5.0 + back % 7));
    });
}
Path spiral(const Path& folder, int n) {
    return polygon(folder, n, [&](int i) {
        const bool inner = i >= n / 2;
        const double t = inner ? n - 1 - i : i;
        const double radius = 10 + 0.01 * t - (inner ? 0.005 : 0.0);
        return Point(radius * std::cos(0.1 * t), radius * std::sin(0.1 * t));
    });
}
Path two_rows(const Path& folder, int n) {
    return polygon(folder, n,
                   [&](int i) { return i < n / 2 ? Point(i, 0.0) : Point(n - 1 - i, 1.0); });
}

/// Corners at one position that differ in all else.
Path corners_at_one_place(const Path& folder, int n) {
    return write_obj(
        folder,
        lines(n,
              [](int i) { return "v " + to_string(i) + " 1 0\nvt 0." + to_string(i) + " 0.5\n"; }) +
            "v 0 0 1\n" + lines(n - 2, [](int i) {
                return "s " + to_string(i + 1) + "\nf -1/" + to_string(i + 1) + ' ' +
                       to_string(i + 1) + "/1 " + to_string(i + 2) + "/2\n";
            }));
}
/// Triangles that share both ends of an edge.
Path triangles_at_one_edge(const Path& folder, int n) {
    return write_obj(folder, lines(n,
                                   [](int i) {
                                       return "v " + to_string(i) + " 1 " + to_string(i * i % 17) +
                                              "\nvt 0." + to_string(i) + " 0.5\n";
                                   }) +
                                 "v 0 0 0\nv 0 0 1\n" + lines(n, [](int i) {
                                     return "f -1/1 -2/1 " + to_string(i + 1) + '/' +
                                            to_string(i + 1) + '\n';
                                 }));
}

/// A smooth sheet of n * n squares, with `line` in place of the first that starts as it does.
Path sheet(const Path& folder, int n, const std::string& head, const std::string& line) {
    std::string text = lines((n + 1) * (n + 1), [n](int i) {
        const double u = i % (n + 1) / double(n), v = i / (n + 1) / double(n);
        return "v " + to_string(u) + " " + to_string(0.1 * std::sin(7 * u * v)) + " " +
               to_string(v) + "\nvt " + to_string(u) + " " + to_string(v) + "\nvn " +
               to_string(u - 0.5) + " 1 " + to_string(v - 0.5) + "\n";
    });
    const auto corner = [](int i) {
        return " " + to_string(i) + "/" + to_string(i) + "/" + to_string(i);
    };
    text += head;
    text += lines(n * n, [&](int i) {
        const int a = i / n * (n + 1) + i % n + 1, b = a + n + 1;
        return "f" + corner(a) + corner(b) + corner(a + 1) + "\nf" + corner(a + 1) + corner(b) +
               corner(b + 1) + "\n";
    });
    if (!line.empty()) {
        const std::size_t at =
            text.find("\n" + line.substr(0, line.find(' ') + 1), text.size() / 3) + 1;
        text.replace(at, text.find('\n', at) - at, line);
    }
    return write_obj(folder, text);
}

}  // namespace

std::vector<Input> nearly_whole_inputs() {
    constexpr int kSide = 170;
    return {
        {"whole", [](const Path& folder, int n) { return sheet(folder, n, "s 1\n", ""); }, kSide},
        {"a normal of length 0, smooth",
         [](const Path& folder, int n) { return sheet(folder, n, "s 1\n", "vn 0 0 0"); }, kSide},
        {"a normal of length 0, flat",
         [](const Path& folder, int n) { return sheet(folder, n, "", "vn 0 0 0"); }, kSide},
        {"a face without normals",
         [](const Path& folder, int n) { return sheet(folder, n, "s 1\n", "f 1/1 2/2 3/3"); },
         kSide},
        {"a UV that is no number",
         [](const Path& folder, int n) { return sheet(folder, n, "s 1\n", "vt nan nan"); }, kSide}};
}

std::vector<Input> obj_inputs() {
    return {{"unknown materials", unknown_materials, 60},
            {"unknown keywords", unknown_keywords, 50},
            {"numbers out of range", numbers_out_of_range, 50},
            {"unknown channels", unknown_channels, 30},
            {"keywords of one material", keywords_of_one_material, 80},
            {"unknown statements", unknown_statements, 500},
            {"bad references", bad_references, 150},
            {"missing libraries", missing_libraries, 10},
            {"one library", one_library, 40},
            {"long names", long_names, 100},
            {"continued face", continued_face, 400},
            {"comb", comb, 250},
            {"spiral", spiral, 250},
            {"two rows", two_rows, 250},
            {"corners at one place", corners_at_one_place, 200},
            {"triangles at one edge", triangles_at_one_edge, 200}};
}
