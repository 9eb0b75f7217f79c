// Lines that are read at a glance mean what they mean when read word by word.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstdlib>

#include "obj_text.h"

namespace {

// A line is looked at whole only where this much text stands around it.
const std::string kMargin(200, '#');

std::string in_margins(const std::string& lines) {
    return kMargin + '\n' + lines + kMargin + '\n';
}

std::vector<std::uint32_t> bits_of(const std::vector<glm::vec3>& vectors) {
    std::vector<std::uint32_t> bits;
    for (const glm::vec3& v : vectors) {
        for (const float x : {v.x, v.y, v.z}) bits.push_back(std::bit_cast<std::uint32_t>(x));
    }
    return bits;
}

TEST(ObjPlainLines, RoundDecimalsAsTheCLibraryDoes) {
    std::mt19937 random(1);
    const auto pick = [&](int low, int high) {
        return std::uniform_int_distribution<int>(low, high)(random);
    };
    const auto digits = [&](int count) {
        std::string text;
        while (count-- > 0) text += static_cast<char>('0' + pick(0, 9));
        return text;
    };
    // Halfway between two floats, and as close to it as seven decimals come.
    const std::vector<std::string> halves{".5", ".5000001", ".4999999", ".50", ".5000000"};
    std::string lines;
    std::vector<float> expected;
    for (int i = 0; i < 30'000; ++i) {
        std::string number = pick(0, 1) ? "-" : "";
        if (pick(0, 3) == 0) {
            number += std::to_string(pick(1 << 23, 9'999'999));
            number += halves[i % halves.size()];
        } else {
            number += digits(pick(1, 8));
            if (pick(0, 7) != 0) number += '.' + digits(pick(0, 8));
        }
        lines += i % 3 == 0 ? "\nv " : " ";
        lines += number;
        expected.push_back(std::strtof(number.c_str(), nullptr) + 0.0f);
    }
    const auto scene = read(in_margins(lines + "\nf 1 2 3\n")).scene;
    std::vector<std::uint32_t> bits;
    for (const float x : expected) bits.push_back(std::bit_cast<std::uint32_t>(x));
    EXPECT_EQ(bits_of(scene.positions), bits);
}

/// Lines of every kind with words of every length, most of them short and sound.
std::string random_lines(std::mt19937& random) {
    const auto pick = [&](int low, int high) {
        return std::uniform_int_distribution<int>(low, high)(random);
    };
    const auto number = [&] {
        const std::string text = std::to_string(pick(-99'999'999, 99'999'999) / 1e4);
        return text.substr(0, text.size() - static_cast<std::size_t>(pick(0, 5)));
    };
    std::string text;
    for (int i = 0; i < 12; ++i) {
        text += fmt::format("v {} {} {}\n", number(), number(), number());
        text += fmt::format("vt {} {}\n", number(), number());
        text += fmt::format("vn {} {} {}\n", number(), number(), number());
    }
    for (int i = 0; i < 12; ++i) {
        const int form = pick(0, 3), corners = pick(3, 6);
        text += "f";
        for (int j = 0; j < corners; ++j) {
            text += fmt::format(" {}", pick(1, 12));
            if (form != 0) text += "/";
            if (form != 0 && form != 2) text += std::to_string(pick(1, 12));
            if (form >= 2) text += fmt::format("/{}", pick(1, 12));
        }
        text += pick(0, 9) == 0 ? " \r\n" : "\n";
    }
    return text;
}

void alter(std::string& text, std::mt19937& random) {
    const auto pick = [&](std::size_t below) {
        return std::uniform_int_distribution<std::size_t>(0, below - 1)(random);
    };
    constexpr std::string_view kOdd = "0123456789--..//  e+\\\r#vftn";
    const std::size_t at = pick(text.size());
    if (pick(2) == 0) {
        text[at] = kOdd[pick(kOdd.size())];
    } else {
        text.insert(at, 1 + pick(8), kOdd[pick(kOdd.size())]);
    }
}

TEST(ObjPlainLines, MeanTheSameWithTabsForBlanks) {
    std::mt19937 random(2);
    const TemporaryFolder folder;
    const auto read_or_error = [&](const std::string& text) {
        std::pair<Reading, std::string> result;
        try {
            result.first = read(folder, in_margins(text), 300);
        } catch (const bake::BakeError& error) {
            result.second = error.what();
        }
        return result;
    };
    int scenes = 0, errors = 0;
    for (int i = 0; i < 3000; ++i) {
        std::string text = random_lines(random);
        for (int n = i % 4; n > 0; --n) alter(text, random);
        std::string tabs = text;  // which no line may have that is read at a glance
        std::replace(tabs.begin(), tabs.end(), ' ', '\t');
        const auto [a, a_error] = read_or_error(text);
        const auto [b, b_error] = read_or_error(tabs);
        ASSERT_EQ(a_error, b_error) << text;
        ASSERT_EQ(bits_of(a.scene.positions), bits_of(b.scene.positions)) << text;
        ASSERT_EQ(bits_of(a.scene.normals), bits_of(b.scene.normals)) << text;
        ASSERT_EQ(corner_values(a.scene), corner_values(b.scene)) << text;
        ASSERT_EQ(a.scene.smoothing_group, b.scene.smoothing_group) << text;
        ASSERT_EQ(a.warnings, b.warnings) << text;
        ++(a_error.empty() ? scenes : errors);
    }
    EXPECT_GT(scenes, 1000);
    EXPECT_GT(errors, 500);
}

}  // namespace
