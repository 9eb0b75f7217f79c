#include <gtest/gtest.h>

#include "cw2-bake/base/file_finder.h"
#include "cw2-bake/obj/read_obj.h"
#include "obj_text.h"

namespace {

namespace fs = std::filesystem;

class Finder : public testing::Test {
 protected:
    /// What is found for a name, relative to the folder, and behind it the note, if there is one.
    std::string find(const std::string& name) {
        bake::FileFinder finder;
        const bake::FoundFile found = finder.find(folder_.path(), bake::readings_of(name));
        EXPECT_EQ(found.exists, fs::exists(found.file));
        std::string note = found.note;
        const std::string prefix = folder_.path().string() + "/";
        for (std::size_t at; (at = note.find(prefix)) != note.npos;) note.erase(at, prefix.size());
        return found.file.lexically_relative(folder_.path()).string() +
               (note.empty() ? "" : ": " + note);
    }
    void write(const std::string& name) {
        fs::create_directories((folder_.path() / name).parent_path());
        folder_.write(name, "");
    }

    TemporaryFolder folder_;
};

TEST_F(Finder, TakesWhatIsNamed) {
    write("tex/Red.png");
    write("tex/red.png");
    write("Tex/red.png");
    write("a\\b.png");
    EXPECT_EQ(find("tex/red.png"), "tex/red.png");
    EXPECT_EQ(find("tex\\red.png"), "tex/red.png");
    EXPECT_EQ(find("a\\b.png"), "a\\b.png");
    EXPECT_EQ(find((folder_.path() / "tex/red.png").string()), "tex/red.png");
}

TEST_F(Finder, TakesAnotherCaseWhereOneFileHasIt) {
    write("Assets/Tex/red.png");
    write("assets/other/x.png");
    write("one.png");
    write("One.png");
    write("\u00c4pfel.png");
    fs::create_directory(folder_.path() / "folder.png");
    EXPECT_EQ(find("ASSETS\\TEX\\RED.PNG"), "Assets/Tex/red.png: Assets/Tex/red.png is taken");
    EXPECT_EQ(find("assets/tex/red.png"), "Assets/Tex/red.png: Assets/Tex/red.png is taken")
        << "though a folder is named exactly";
    EXPECT_EQ(find("ONE.png"), "ONE.png: there is One.png, one.png");
    EXPECT_EQ(find("\u00e4PFEL.png"), "\u00c4pfel.png: \u00c4pfel.png is taken");
    EXPECT_EQ(find("FOLDER.png").find("taken"), std::string::npos);
}

TEST_F(Finder, TakesTheLastComponentBesideTheOneThatNamesIt) {
    write("red.png");
    write("sub/blue.png");
    for (const char* name : {"C:\\Users\\x\\My Documents\\red.png", "/home/x/red.png",
                             "\\\\server\\share\\RED.png", "../../maps/red.png", "D:/a/b/Red.PNG"})
        EXPECT_EQ(find(name), "red.png: red.png is taken") << name;
    EXPECT_EQ(find("C:\\blue.png"), "C:/blue.png");
}

TEST_F(Finder, NamesNearMisses) {
    write("stone_wall.jpg");
    write("stone_wal.png");
    write("grass.png");
    EXPECT_EQ(find("stone_wall.png"), "stone_wall.png: there is stone_wall.jpg, stone_wal.png");
    EXPECT_EQ(find("C:\\x\\Stone_Wall.tga"), "C:/x/Stone_Wall.tga: there is stone_wall.jpg");
    EXPECT_EQ(find("gras.png"), "gras.png: there is grass.png");
    EXPECT_EQ(find("wood.png"), "wood.png");
}

/// What reading an OBJ with this mtllib line warns of, where x.mtl and "a b.mtl" define the
/// material.
std::vector<std::string> warnings_of(const std::string& line, const std::string& own = "") {
    const TemporaryFolder folder;
    for (const char* name : {"x.mtl", "a b.mtl"}) folder.write(name, "newmtl m\nKd 1 0 0\n");
    if (!own.empty()) folder.write(own, "newmtl m\nKd 1 0 0\n");
    const Reading reading = read(folder, line + "\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n");
    const bool is_red = reading.scene.materials.at(0).base_color == glm::vec3(1, 0, 0);
    std::vector<std::string> warnings = reading.warnings;
    if (!is_red) warnings.push_back("(grey)");
    return warnings;
}

TEST(Mtllib, IsReadInEveryWayThatFindsALibrary) {
    using Lines = std::vector<std::string>;
    for (const char* line :
         {"mtllib x.mtl", "mtllib \"x.mtl\"", "mtllib a b.mtl", "mtllib \"a b.mtl\"",
          "mtllib x.mtl a b.mtl", "mtllib \"a b.mtl\" \"x.mtl\"", "mtllib .\\x.mtl"})
        EXPECT_EQ(warnings_of(line), Lines{}) << line;
    EXPECT_EQ(warnings_of("mtllib X.MTL"),
              Lines{"scene.obj:1: no material library 'X.MTL'; x.mtl is taken"});
    EXPECT_EQ(warnings_of("mtllib C:\\Users\\me\\a b.mtl"),
              Lines{"scene.obj:1: no material library 'C:\\Users\\me\\a b.mtl'; a b.mtl is taken"});
    EXPECT_EQ(warnings_of("mtllib one.mtl two.mtl", "scene.mtl"),
              Lines{"scene.obj:1: no material library 'one.mtl'; scene.mtl is taken"});
    EXPECT_EQ(warnings_of("", "scene.mtl"),
              Lines{"scene.obj: no material library is named; scene.mtl is taken"});
    EXPECT_EQ(warnings_of("mtllib xx.mtl"),
              (Lines{"scene.obj:1: no material library 'xx.mtl'; there is x.mtl", "(grey)"}));
    EXPECT_EQ(warnings_of("mtllib one.mtl two.mtl"),
              (Lines{"scene.obj:1: no material library 'one.mtl'",
                     "scene.obj:1: no material library 'two.mtl'", "(grey)"}));
}

/// A scene's folder in a folder with a file that is none of its business.
class RestrictedFinder : public testing::Test {
 protected:
    RestrictedFinder() {
        for (const char* folder : {"scene/tex", "scene2"})
            fs::create_directories(folder_.path() / folder);
        for (const char* name : {"secret.png", "scene2/secret.png", "scene/tex/red.png"})
            folder_.write(name, "");
        fs::create_symlink("../secret.png", root_ / "link.png");
        fs::create_symlink("tex/red.png", root_ / "inside.png");
        fs::create_symlink("..", root_ / "up");
    }
    bake::FoundFile find(const std::string& name) {
        bake::FileFinder finder(root_);
        return finder.find(root_ / "tex", bake::readings_of(name));
    }

    TemporaryFolder folder_;
    fs::path root_ = folder_.path() / "scene";
};

TEST_F(RestrictedFinder, SeesNothingOutside) {
    const std::string absolute = (folder_.path() / "secret.png").string();
    for (const std::string& name :
         {absolute, std::string("../../secret.png"), std::string("..\\..\\secret.png"),
          std::string("../link.png"), std::string("../up/secret.png"),
          std::string("../UP/secret.png"), std::string("../../scene2/secret.png"),
          std::string("../../SECRET.PNG"), std::string("/etc/passwd"), std::string("../..")}) {
        const bake::FoundFile found = find(name);
        EXPECT_FALSE(found.exists) << name;
        EXPECT_EQ(found.note.find("there is"), found.note.npos) << name << ": " << found.note;
        EXPECT_EQ(found.is_outside, name != "../UP/secret.png") << name;
    }
    // Near misses would tell of others' files.
    EXPECT_EQ(find("../../secre.png").note, "it is outside the scene's folder");
}

TEST_F(RestrictedFinder, FindsWhatIsInside) {
    for (const std::string name : {"red.png", "RED.png", "../tex/red.png", "../inside.png",
                                   "../../scene/tex/red.png", "/home/somebody/red.png"}) {
        const bake::FoundFile found = find(name);
        ASSERT_TRUE(found.exists) << name;
        EXPECT_TRUE(fs::equivalent(found.file, root_ / "tex/red.png")) << name;
    }
}

}  // namespace
