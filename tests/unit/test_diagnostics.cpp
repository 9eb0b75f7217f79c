#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "cw2-bake/base/diagnostics.h"
#include "cw2-bake/base/text_lines.h"

namespace {

std::vector<std::string> told(const std::vector<std::string>& warnings) {
    std::vector<std::string> lines;
    const bake::Warn warn = [&](const std::string& line) { lines.push_back(line); };
    bake::WarningFilter filter(warn);
    for (const std::string& warning : warnings) filter.filtered()(warning);
    filter.tell_rest();
    return lines;
}

TEST(WarningFilter, TenOfAKindAreToldAndTheOthersCounted) {
    std::vector<std::string> warnings;
    for (int i = 1; i <= 10; ++i) {
        warnings.push_back("a.obj:" + std::to_string(i) + ": no library defines '" +
                           std::string(static_cast<std::size_t>(i), 'x') + "'; a default is used");
    }
    EXPECT_EQ(told(warnings), warnings);
    warnings.insert(warnings.begin() + 5, "a.obj:2: is odd");
    EXPECT_EQ(told(warnings), warnings);
    const std::string eleventh = "b.obj:700: no library defines 'y'; there is c.mtl";
    warnings.push_back(eleventh);
    EXPECT_EQ(told(warnings), warnings);
    for (int i = 0; i < 1000; ++i) warnings.push_back("c.obj:7: no library defines 'z'; a default");
    const std::vector<std::string> lines = told(warnings);
    ASSERT_EQ(lines.size(), 12u);
    EXPECT_EQ(lines.back(), eleventh + " (and 1000 more of this kind)");
}

TEST(WarningFilter, AnApostropheInAWordQuotesNothing) {
    std::vector<std::string> different;
    for (const char* odd : {"a", "b", "c", "d", "e", "f", "g", "h", "i", "j", "k", "l"})
        different.push_back(std::string("/home/o'brien/a.obj:3: ") + odd + " is odd");
    EXPECT_EQ(told(different), different);
    std::vector<std::string> same;
    for (char c = 'a'; c <= 'z'; ++c)
        same.push_back(std::string("/home/o'brien/a.obj:3: no texture 'it's ") + c + ".png' here");
    EXPECT_EQ(told(same).size(), 11u);
}

TEST(LineCounter, TellsWhatCountingFromTheStartTells) {
    const std::string text = "a\nb\r\nc\rd\n\n\r\n\re";
    for (std::size_t first = 0; first <= text.size() + 1; ++first) {
        for (std::size_t second = 0; second <= text.size() + 1; ++second) {
            bake::LineCounter counter(text);
            EXPECT_EQ(counter.at(first), bake::line_number(text, first));
            EXPECT_EQ(counter.at(second), bake::line_number(text, second)) << first << second;
        }
    }
    EXPECT_EQ(bake::line_number(text, text.size()), 8u);
}

TEST(LineCounter, GoesOnFromWhatWasCountedBefore) {
    const std::string text = "a\nb\r\nc\rd\n\n\r\n\re";
    const std::size_t second = text.find('c'), third = text.find("\n\n") + 1;
    for (std::size_t first = 0; first <= text.size(); ++first) {
        for (std::size_t next = 0; next <= text.size(); ++next) {
            bake::LineCounter counter(text);
            counter.add_counted(2, second);
            counter.add_counted(2, third);
            EXPECT_EQ(counter.at(first), bake::line_number(text, first));
            EXPECT_EQ(counter.at(next), bake::line_number(text, next)) << first << next;
        }
    }
    // It does not look at what it was told of.
    const std::string blank(text.size(), ' ');
    bake::LineCounter counter(blank);
    counter.add_counted(5, third);
    EXPECT_EQ(counter.at(third + 1), 6u);
}

}  // namespace
