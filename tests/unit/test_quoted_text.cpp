// Names of any bytes are valid JSON.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <random>
#include <string>

#include "common/quoted_text.h"

namespace {

using common::quoted_text;
using nlohmann::json;

TEST(QuotedText, IsReadAsItWas) {
    std::string all;
    for (char c = 0; c >= 0 && c < 0x7F; ++c) all += c;
    for (const std::string& text : {all, std::string("\x7f\u00fc\u2603\U0001F600\U0010FFFF"),
                                    std::string(R"(C:\new "one")"), std::string()}) {
        EXPECT_EQ(json::parse(quoted_text(text)), text);
    }
}

TEST(QuotedText, WhatIsNoUtf8IsReplacedAsAnotherJsonWriterDoes) {
    EXPECT_EQ(quoted_text("gr\xFC\x6E"), "\"gr\uFFFDn\"");
    const std::string parts[] = {"a",        "\x80",     "\xBF",         "\xC3",     "\xC1",
                                 "\xE2\x98", "\xE0\x80", "\xED\xA0\x80", "\xF0\x9F", "\xF4\x90",
                                 "\xFF",     "\xF5",     "\u00fc",       "\u2603",   "\U0001F600"};
    std::mt19937 random(1);
    for (int i = 0; i < 5000; ++i) {
        std::string text;
        while (random() % 6 != 0) {
            text += random() % 4 == 0 ? std::string(1, static_cast<char>(random()))
                                      : parts[random() % std::size(parts)];
        }
        const std::string theirs = json(text).dump(-1, ' ', false, json::error_handler_t::replace);
        ASSERT_EQ(json::parse(quoted_text(text)), json::parse(theirs));
    }
}

}  // namespace
