// What the demo scene promises: the same bytes whatever the threads, sound indices and winding,
// textures that exist, arches whose UVs are mirrored, a closed sculpture.
#include <gtest/gtest.h>
#include <sched.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <glm/glm.hpp>
#include <iterator>
#include <map>
#include <set>
#include <sstream>

#include "assets/demo_scene.h"

namespace {

namespace fs = std::filesystem;

struct Corner {
    std::size_t position, uv, normal;
};

struct Face {
    std::vector<Corner> corners;
    std::string material;
};

struct Obj {
    std::vector<glm::vec3> positions;
    std::vector<glm::vec3> normals;
    std::vector<glm::vec2> uvs;
    std::vector<Face> faces;

    glm::vec3 position(const Corner& corner) const { return positions[corner.position]; }
    glm::vec3 area(const Face& face) const {
        glm::vec3 sum(0.0f);
        for (std::size_t i = 2; i < face.corners.size(); ++i) {
            const glm::vec3 from = position(face.corners[0]);
            sum +=
                glm::cross(position(face.corners[i - 1]) - from, position(face.corners[i]) - from);
        }
        return sum;
    }
};

Obj read(const fs::path& path) {
    Obj obj;
    std::ifstream file(path);
    std::string material;
    for (std::string line; std::getline(file, line);) {
        std::istringstream words(line);
        std::string keyword;
        words >> keyword;
        if (keyword == "v" || keyword == "vn") {
            glm::vec3& value = (keyword == "v" ? obj.positions : obj.normals).emplace_back();
            words >> value.x >> value.y >> value.z;
        } else if (keyword == "vt") {
            glm::vec2& value = obj.uvs.emplace_back();
            words >> value.x >> value.y;
        } else if (keyword == "usemtl") {
            words >> material;
        } else if (keyword == "f") {
            Face face{{}, material};
            Corner corner{};
            char slash{};
            while (words >> corner.position >> slash >> corner.uv >> slash >> corner.normal) {
                face.corners.push_back({corner.position - 1, corner.uv - 1, corner.normal - 1});
            }
            obj.faces.push_back(std::move(face));
        }
        EXPECT_TRUE(!words.bad()) << line;
    }
    return obj;
}

std::string bytes_of(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

std::set<fs::path> files_in(const fs::path& directory) {
    std::set<fs::path> files;
    for (const auto& entry : fs::recursive_directory_iterator(directory)) {
        if (entry.is_regular_file()) files.insert(fs::relative(entry.path(), directory));
    }
    return files;
}

class DemoScene : public testing::Test {
 protected:
    /// Makes the scene again on one core; the build made it on all of them.
    static void SetUpTestSuite() {
        made = fs::path(testing::TempDir()) / "cw2-demo-scene-test";
        fs::remove_all(made);
        cpu_set_t all;
        ASSERT_EQ(sched_getaffinity(0, sizeof all, &all), 0);
        int first = 0;
        while (!CPU_ISSET(first, &all)) ++first;
        cpu_set_t one;
        CPU_ZERO(&one);
        CPU_SET(first, &one);
        ASSERT_EQ(sched_setaffinity(0, sizeof one, &one), 0);
        assets::write_demo_scene(made);
        ASSERT_EQ(sched_setaffinity(0, sizeof all, &all), 0);
        obj = read(made / "courtyard.obj");
    }
    static void TearDownTestSuite() { fs::remove_all(made); }

    static inline fs::path made;
    static inline Obj obj;
};

TEST_F(DemoScene, OneThreadMakesTheBytesThatTheBuildMadeWithAll) {
    const fs::path built = DEMO_DIRECTORY;
    ASSERT_EQ(files_in(made), files_in(built));
    for (const fs::path& file : files_in(made)) {
        EXPECT_TRUE(bytes_of(made / file) == bytes_of(built / file)) << file;
    }
}

TEST_F(DemoScene, HasAtLeastAHundredThousandTriangles) {
    std::size_t triangles = 0;
    for (const Face& face : obj.faces) triangles += face.corners.size() - 2;
    EXPECT_GE(triangles, 100'000u);
}

TEST_F(DemoScene, EveryIndexIsInRangeAndEveryNormalHasUnitLength) {
    ASSERT_FALSE(obj.faces.empty());
    for (const Face& face : obj.faces) {
        ASSERT_GE(face.corners.size(), 3u);
        for (const Corner& corner : face.corners) {
            ASSERT_LT(corner.position, obj.positions.size());
            ASSERT_LT(corner.uv, obj.uvs.size());
            ASSERT_LT(corner.normal, obj.normals.size());
        }
    }
    for (const glm::vec3& normal : obj.normals) ASSERT_NEAR(glm::length(normal), 1.0f, 1e-4f);
}

TEST_F(DemoScene, AttributesAreWrittenOnce) {
    const auto distinct = [](const auto& values) {
        std::set<std::array<float, 3>> seen;
        for (const auto& value : values) {
            std::array<float, 3> key{};
            for (int i = 0; i < value.length(); ++i) key[static_cast<std::size_t>(i)] = value[i];
            seen.insert(key);
        }
        return seen.size();
    };
    EXPECT_EQ(distinct(obj.positions), obj.positions.size());
    EXPECT_EQ(distinct(obj.normals), obj.normals.size());
    EXPECT_EQ(distinct(obj.uvs), obj.uvs.size());
}

TEST_F(DemoScene, SolidFacesAreWoundAsTheirNormalsPoint) {
    const std::set<std::string> cards{"laurel", "ivy", "frond", "chain"};
    std::size_t faces = 0;
    std::map<std::string, std::size_t> against;
    for (const Face& face : obj.faces) {
        if (cards.contains(face.material)) continue;
        glm::vec3 normal(0.0f);
        for (const Corner& corner : face.corners) normal += obj.normals[corner.normal];
        ++faces;
        if (glm::dot(obj.area(face), normal) <= 0.0f) ++against[face.material];
    }
    ASSERT_GT(faces, 50'000u);
    for (const auto& [material, count] : against) {
        // Where the mane's locks meet in a crease, a small face may lean away.
        EXPECT_TRUE(material == "bronze" && count < 200) << material << ": " << count;
    }
}

TEST_F(DemoScene, EveryMaterialIsDefinedAndEveryTextureExistsAndIsLargeEnough) {
    std::set<std::string> defined;
    std::set<fs::path> named;
    std::istringstream mtl(bytes_of(made / "courtyard.mtl"));
    std::set<std::string> statements;
    for (std::string keyword, value; mtl >> keyword >> value;) {
        statements.insert(keyword);
        if (keyword == "newmtl") defined.insert(value);
        if (keyword == "Kd") mtl >> keyword >> keyword;
        if (!value.ends_with(".png")) continue;
        named.insert(value);
        const std::string png = bytes_of(made / value);
        ASSERT_GT(png.size(), 24u) << value;
        for (const std::size_t at : {16u, 20u}) {  // width and height in the IHDR chunk
            unsigned extent = 0;
            for (std::size_t i = at; i < at + 4; ++i) {
                extent = extent * 256 + static_cast<unsigned char>(png[i]);
            }
            EXPECT_GE(extent, 512u) << value;
        }
    }
    for (const char* keyword : {"Kd", "Pr", "Pm", "map_Kd", "map_Pr", "map_Pm", "norm", "map_d"}) {
        EXPECT_TRUE(statements.contains(keyword)) << keyword;
    }
    for (const Face& face : obj.faces) ASSERT_TRUE(defined.contains(face.material));
    for (const fs::path& file : files_in(made)) {
        EXPECT_TRUE(file.extension() != ".png" || named.contains(file)) << file << " is not used";
    }
}

/// Positive where the UVs of a face turn as its corners do.
float uv_area(const Obj& obj, const Face& face) {
    float sum = 0.0f;
    for (std::size_t i = 0; i < face.corners.size(); ++i) {
        const glm::vec2 a = obj.uvs[face.corners[i].uv];
        const glm::vec2 b = obj.uvs[face.corners[(i + 1) % face.corners.size()].uv];
        sum += a.x * b.y - a.y * b.x;
    }
    return sum;
}

TEST_F(DemoScene, TheArchesUvsFlipTheirHandAtTheKeystone) {
    using Edge = std::array<std::size_t, 6>;  // two corners
    std::map<Edge, const Face*> by_edge;
    std::size_t seams = 0;
    for (const Face& face : obj.faces) {
        if (face.material != "voussoir") continue;
        for (std::size_t i = 0; i < face.corners.size(); ++i) {
            const Corner& a = face.corners[i];
            const Corner& b = face.corners[(i + 1) % face.corners.size()];
            const auto edge = [](const Corner& from, const Corner& to) {
                return Edge{from.position, from.uv, from.normal, to.position, to.uv, to.normal};
            };
            by_edge[edge(a, b)] = &face;
            const auto other = by_edge.find(edge(b, a));
            if (other == by_edge.end()) continue;
            if (uv_area(obj, face) * uv_area(obj, *other->second) < 0.0f) ++seams;
        }
    }
    // Twelve bays of two storeys, each with a front, a back and a soffit.
    EXPECT_EQ(seams, 12u * 2u * 3u);
}

TEST_F(DemoScene, TheSculptureIsAClosedSurface) {
    std::map<std::pair<std::size_t, std::size_t>, int> balance;
    std::size_t faces = 0;
    for (const Face& face : obj.faces) {
        if (face.material != "bronze") continue;
        ++faces;
        for (std::size_t i = 0; i < face.corners.size(); ++i) {
            const std::size_t a = face.corners[i].position;
            const std::size_t b = face.corners[(i + 1) % face.corners.size()].position;
            ++balance[{a, b}];
            --balance[{b, a}];
        }
    }
    ASSERT_GT(faces, 10'000u);
    EXPECT_TRUE(std::all_of(balance.begin(), balance.end(),
                            [](const auto& edge) { return edge.second == 0; }));
}

}  // namespace
