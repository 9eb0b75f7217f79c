// Properties of the packed tangent frames, against the truth of tests/frame_truth.h.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <thread>
#include <vector>

#include "mesh-format/tangent_frame.h"
#include "tests/frame_truth.h"

namespace {

using namespace frame_truth;
using mesh_format::FrameForm;
using Bytes = std::array<std::byte, 16>;

constexpr FrameForm kForms[] = {FrameForm::quat48, FrameForm::quat32, FrameForm::half3,
                                FrameForm::f32};
constexpr const char* kNames[] = {"quat48", "quat32", "half3", "f32"};
constexpr double kWorst[] = {0.0050, 0.193, 3.3, 3e-5};  // degrees
constexpr double kMean[] = {0.0023, 0.094, 0.084, 0};
constexpr int kQuat48Half = 16383;
constexpr int kQuat32Half = 405;

std::size_t index_of(FrameForm form) {
    return static_cast<std::size_t>(form);
}

Bytes packed(FrameForm form, const TangentFrame& frame) {
    Bytes bytes{};
    mesh_format::pack_frame(form, frame, bytes.data());
    return bytes;
}
TangentFrame unpacked(FrameForm form, const Bytes& bytes) {
    return mesh_format::unpack_frame(form, bytes.data());
}
TangentFrame round_trip(FrameForm form, const TangentFrame& frame) {
    return unpacked(form, packed(form, frame));
}

/// The largest difference of a vector component; infinite if the handedness differs or a is NaN.
double distance(const TangentFrame& a, const TangentFrame& b) {
    double largest = 0;
    bool comparable = a.handedness == b.handedness;
    for (int i = 0; i < 3; ++i) {
        for (const double d : {a.tangent[i] - b.tangent[i], a.normal[i] - b.normal[i]}) {
            comparable = comparable && std::isfinite(d);
            largest = std::max(largest, std::abs(d));
        }
    }
    return comparable ? largest : std::numeric_limits<double>::infinity();
}

/// How far tangent and normal are from orthonormal; infinite if any number is not finite or the
/// handedness is not +-1.
double defect(const TangentFrame& frame) {
    const Vec3 t = wide(frame.tangent);
    const Vec3 n = wide(frame.normal);
    const double sum = std::abs(dot(t, t) - 1) + std::abs(dot(n, n) - 1) + std::abs(dot(t, n));
    return std::isfinite(sum) && std::abs(frame.handedness) == 1.0f
               ? sum
               : std::numeric_limits<double>::infinity();
}

struct Errors {
    std::uint64_t count = 0;
    std::uint64_t hands_lost = 0;
    double sum = 0;
    double worst = 0;

    void add(FrameForm form, const Quaternion& q, bool left_handed) {
        const TangentFrame decoded = round_trip(form, frame_of(q, left_handed));
        const double angle = rotation_angle(columns(q), columns(decoded));
        ++count;
        hands_lost += decoded.handedness != (left_handed ? -1.0f : 1.0f);
        sum += angle;
        worst = std::isnan(angle) ? 360 : std::max(worst, angle);
    }
    void add(const Errors& other) {
        count += other.count;
        hands_lost += other.hands_lost;
        sum += other.sum;
        worst = std::max(worst, other.worst);
    }
};

/// The sum of `work(random, part)` over a fixed number of parts, spread over the processors.
Errors in_parallel(const std::function<Errors(Random&, unsigned part)>& work) {
    constexpr unsigned kParts = 8;
    const unsigned threads = std::clamp(std::thread::hardware_concurrency(), 1u, kParts);
    std::array<Errors, kParts> parts;
    std::vector<std::thread> running;
    for (unsigned first = 0; first < threads; ++first) {
        running.emplace_back([&, first] {
            for (unsigned part = first; part < kParts; part += threads) {
                Random random(part + 1);
                parts[part] = work(random, part);
            }
        });
    }
    for (std::thread& thread : running) thread.join();
    Errors all;
    for (const Errors& part : parts) all.add(part);
    return all;
}

void expect_within_bounds(FrameForm form, const Errors& errors) {
    EXPECT_EQ(errors.hands_lost, 0u);
    EXPECT_LE(errors.worst, kWorst[index_of(form)]);
    testing::Test::RecordProperty("frames", std::to_string(errors.count));
    std::printf("    %s: %llu frames, mean %.6f, worst %.6f degrees\n", kNames[index_of(form)],
                static_cast<unsigned long long>(errors.count),
                errors.sum / static_cast<double>(errors.count), errors.worst);
}

class TangentFrames : public testing::TestWithParam<FrameForm> {};

TEST_P(TangentFrames, RandomFramesKeepTheirHandAndTheBounds) {
    const FrameForm form = GetParam();
    const Errors errors = in_parallel([form](Random& random, unsigned) {
        Errors part;
        for (int i = 0; i < 250'000; ++i) part.add(form, random_rotation(random), i & 1);
        return part;
    });
    expect_within_bounds(form, errors);
    const double mean = errors.sum / static_cast<double>(errors.count);
    if (form == FrameForm::f32) {
        EXPECT_LT(mean, 1e-5);
    } else {
        EXPECT_NEAR(mean, kMean[index_of(form)], 0.05 * kMean[index_of(form)]);
    }
}

TEST_P(TangentFrames, AdversarialFramesKeepTheirHandAndTheBounds) {
    const FrameForm form = GetParam();
    expect_within_bounds(form, in_parallel([form](Random& random, unsigned) {
                             Errors part;
                             for (int i = 0; i < 150'000; ++i) {
                                 part.add(form, adversarial_rotation(random), i & 1);
                             }
                             return part;
                         }));
}

class DigitFrames : public testing::TestWithParam<FrameForm> {
 protected:
    int half() const { return GetParam() == FrameForm::quat48 ? kQuat48Half : kQuat32Half; }

    /// Frames for every level of every digit, for every largest component and both hands:
    /// `offset` levels off the level's centre, the other two digits at random levels and as far
    /// off.
    Errors at_every_level(double offset, int repeats) const {
        return in_parallel([=, this](Random& random, unsigned part) {
            Errors errors;
            const unsigned largest = part >> 1;
            for (int i = 0; i < 3 * (2 * half() + 1) * repeats; ++i) {
                const int level = i / 3 / repeats - half();
                double q[4] = {1, 1, 1, 1};
                for (int k = 0; k < 3; ++k) {
                    const int any = static_cast<int>(random() % (2 * half() + 1)) - half();
                    const double warped =
                        ((k == i % 3 ? level : any) + (random() & 1 ? offset : -offset)) / half();
                    q[(largest + 1 + k) % 4] =
                        std::tan(std::clamp(warped, -1.0, 1.0) * std::numbers::pi / 4);
                }
                errors.add(GetParam(), Quaternion::unit(q[0], q[1], q[2], q[3]), part & 1);
            }
            return errors;
        });
    }
};

TEST_P(DigitFrames, EveryLevelsEndsKeepTheBounds) {
    expect_within_bounds(GetParam(),
                         at_every_level(0.4999, GetParam() == FrameForm::quat48 ? 2 : 60));
}

TEST_P(DigitFrames, EveryLevelsCentreComesBackAsItWent) {
    const Errors errors = at_every_level(0, 1);
    EXPECT_EQ(errors.hands_lost, 0u);
    EXPECT_LE(errors.worst, kWorst[index_of(FrameForm::f32)]);
}

INSTANTIATE_TEST_SUITE_P(Forms, DigitFrames, testing::Values(FrameForm::quat48, FrameForm::quat32),
                         [](const auto& param) { return kNames[index_of(param.param)]; });

/// The value of the half with these bits, of magnitude below 2.
double value_of_half(std::uint16_t bits) {
    const int magnitude = bits & 0x3FFF;
    const double value = magnitude < 0x400
                             ? std::ldexp(magnitude, -24)
                             : std::ldexp(0x400 | (magnitude & 0x3FF), (magnitude >> 10) - 25);
    return bits & 0x8000 ? -value : value;
}

TEST(HalfFrames, EveryHalfsCentreAndEndsKeepTheBounds) {
    expect_within_bounds(
        FrameForm::half3, in_parallel([](Random& random, unsigned part) {
            Errors errors;
            for (std::uint16_t bits = 0; bits < 0x3C00; ++bits) {
                for (int k = 0; k < 9; ++k) {
                    const double low = value_of_half(bits);
                    const double high = value_of_half(bits + 1);
                    const double at = low + (high - low) * (k / 3 == 0   ? 0
                                                            : k / 3 == 1 ? 0.4999
                                                                         : 0.5001);
                    Vec3 others = random_rotation(random).rotate({0, 0, std::sqrt(1 - at * at)});
                    if (part & 2) others[2] *= 1e-3;
                    double q[4] = {others[0], others[1], others[2], others[2]};
                    q[k % 3] = 0;
                    const double rest =
                        std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
                    for (double& component : q) component *= std::sqrt(1 - at * at) / rest;
                    q[k % 3] = at;
                    errors.add(FrameForm::half3, Quaternion::unit(q[0], q[1], q[2], q[3]),
                               part & 1);
                }
            }
            return errors;
        }));
}

/// Every code within the unit ball, also those that the encoder would write for no frame.
TEST(HalfFrames, CodesNoLongerThanOneDecodeAndEncodeToThemselves) {
    Random random(1);
    double worst = 0;
    for (int i = 0; i < 1'000'000;) {
        std::uint16_t parts[3];
        double squared = 0;
        for (std::uint16_t& part : parts) {
            // Mostly from 0.25 to 1, where the length comes near 1.
            const auto bits = static_cast<std::uint16_t>(random());
            part =
                static_cast<std::uint16_t>(random() & 7 ? (bits & 0x87FF) + 0x3400 : bits & 0xBFFF);
            squared += value_of_half(part) * value_of_half(part);
        }
        if (squared > 1) continue;
        ++i;
        Bytes bytes{};
        std::memcpy(bytes.data(), parts, sizeof parts);
        const TangentFrame once = unpacked(FrameForm::half3, bytes);
        worst = std::max(worst, distance(round_trip(FrameForm::half3, once), once));
    }
    EXPECT_LE(worst, 1e-6);
}

TEST_P(TangentFrames, TheAxisFramesAreExactForBothHands) {
    int frames = 0;
    for (int axes = 0; axes < 36; ++axes) {
        const int along = axes % 6 / 2;
        const int up = axes / 12;
        if (along == up) continue;
        for (const float hand : {1.0f, -1.0f}) {
            TangentFrame frame{{}, {}, hand};
            frame.tangent[along] = axes & 1 ? -1.0f : 1.0f;
            frame.normal[up] = axes / 6 & 1 ? -1.0f : 1.0f;
            EXPECT_EQ(distance(round_trip(GetParam(), frame), frame), 0.0) << "frame " << axes;
            ++frames;
        }
    }
    EXPECT_EQ(frames, 48);
}

/// Codes that pack_frame wrote, and random bytes. A half3 code much longer than 1, which no
/// pack_frame writes, decodes to half turns between the codes; it may move by a half's rounding.
TEST_P(TangentFrames, DecodingEncodingAndDecodingAgainChangesNothing) {
    const FrameForm form = GetParam();
    Random random(1);
    double worst_written = 0;
    double worst_any = 0;
    for (int i = 0; i < 400'000; ++i) {
        const Quaternion q = i & 1 ? random_rotation(random) : adversarial_rotation(random);
        const TangentFrame once = round_trip(form, frame_of(q, i & 2));
        worst_written = std::max(worst_written, distance(round_trip(form, once), once));

        Bytes bytes;
        for (std::byte& byte : bytes) byte = static_cast<std::byte>(random());
        const TangentFrame any = unpacked(form, bytes);
        worst_any = std::max(worst_any, distance(round_trip(form, any), any));
    }
    EXPECT_LE(worst_written, 1e-6);
    EXPECT_LE(worst_any, form == FrameForm::half3 ? 2e-3 : 1e-6);
}

TEST_P(TangentFrames, DigitsAtTheirEndsAndMiddleDecodeAndEncodeToThemselves) {
    const FrameForm form = GetParam();
    const std::uint32_t words[] = {0,      1,      0x3BFF, 0x3C00, 0x3C01, 0x3FFE, 0x3FFF, 0x4000,
                                   0x7FFD, 0x7FFE, 0x7FFF, 0x8000, 0xBC00, 0xBFFF, 0xFFFE, 0xFFFF};
    double worst = 0;
    for (int code = 0; code < 16 * 16 * 16; ++code) {
        const std::uint16_t parts[3] = {static_cast<std::uint16_t>(words[code % 16]),
                                        static_cast<std::uint16_t>(words[code / 16 % 16]),
                                        static_cast<std::uint16_t>(words[code / 256])};
        Bytes bytes{};
        std::memcpy(bytes.data(), parts, sizeof parts);
        const TangentFrame once = unpacked(form, bytes);
        worst = std::max(worst, distance(round_trip(form, once), once));
    }
    EXPECT_LE(worst, form == FrameForm::half3 ? 2e-3 : 1e-6);
}

TEST_P(TangentFrames, AnyBytesDecodeToAnOrthonormalFrame) {
    Random random(1);
    double worst = 0;
    for (int i = 0; i < 400'000; ++i) {
        Bytes bytes;
        for (std::byte& byte : bytes) byte = static_cast<std::byte>(random());
        worst = std::max(worst, defect(unpacked(GetParam(), bytes)));
    }
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    const float odd[] = {0.0f,  -0.0f,     1e-45f,     1e-30f, 1.0f,
                         -1.0f, kInfinity, -kInfinity, 3e38f,  std::nanf("")};
    for (int i = 0; i < 10'000; ++i) {
        const float parts[4] = {odd[i % 10], odd[i / 10 % 10], odd[i / 100 % 10], odd[i / 1000]};
        worst = std::max(worst, defect(unpacked(GetParam(), std::bit_cast<Bytes>(parts))));
    }
    EXPECT_LE(worst, 2e-6);
}

TEST_P(TangentFrames, DegenerateInputGivesAFrameAboutTheNormal) {
    const float nan = std::nanf("");
    const float infinity = std::numeric_limits<float>::infinity();
    const TangentFrame up{{1, 0, 0}, {0, 0, 1}, 1};
    const double bound = std::sin(kWorst[index_of(GetParam())] / kDegrees);
    Random random(1);
    for (int i = 0; i < 1000; ++i) {
        const TangentFrame valid = frame_of(random_rotation(random), i & 1);
        const auto& n = valid.normal;
        const float tangents[][3] = {{0, 0, 0},
                                     {nan, 0, 1},
                                     {infinity, 0, 0},
                                     {infinity, -infinity, 1},
                                     {n[0], n[1], n[2]},
                                     {-3 * n[0], -3 * n[1], -3 * n[2]},
                                     {1e-30f * n[0], 1e-30f * n[1], 1e-30f * n[2]}};
        for (const auto& tangent : tangents) {
            TangentFrame frame = valid;
            std::copy_n(tangent, 3, frame.tangent);
            const TangentFrame decoded = round_trip(GetParam(), frame);
            ASSERT_LE(defect(decoded), 2e-6);
            const Vec3 sine = cross(wide(decoded.normal), wide(valid.normal));
            ASSERT_LE(std::sqrt(dot(sine, sine)), bound + 1e-6);
            ASSERT_GT(dot(wide(decoded.normal), wide(valid.normal)), 0);
            ASSERT_EQ(decoded.handedness, valid.handedness);
        }
    }
    for (const float bad : {0.0f, nan, infinity}) {
        EXPECT_EQ(distance(round_trip(GetParam(), {{1, 0, 0}, {bad, 0, 0}, 1}), up), 0.0);
        EXPECT_EQ(distance(round_trip(GetParam(), {{bad, 0, 0}, {0, 0, bad}, 1}), up), 0.0);
    }
}

TEST_P(TangentFrames, LengthsDoNotMatterAndTheTangentIsMadeOrthogonal) {
    Random random(1);
    std::uniform_real_distribution<float> exponent(-35, 35);
    std::uniform_real_distribution<float> lean(-2, 2);
    const double bound = kWorst[index_of(GetParam())];
    for (int i = 0; i < 10'000; ++i) {
        const Quaternion q = random_rotation(random);
        TangentFrame frame = frame_of(q, i & 1);
        const float normal_length = std::pow(10.0f, exponent(random));
        const float tangent_length = std::pow(10.0f, exponent(random));
        const float along = lean(random);
        for (int k = 0; k < 3; ++k) {
            frame.tangent[k] = tangent_length * (frame.tangent[k] + along * frame.normal[k]);
            frame.normal[k] *= normal_length;
        }
        const TangentFrame decoded = round_trip(GetParam(), frame);
        ASSERT_LE(rotation_angle(columns(q), columns(decoded)), bound + 1e-4);
    }
}

INSTANTIATE_TEST_SUITE_P(Forms, TangentFrames, testing::ValuesIn(kForms),
                         [](const auto& param) { return kNames[index_of(param.param)]; });

TEST(FrameAngle, IsTheAngleOfTheRotationBetweenTheFrames) {
    Random random(1);
    for (const double degrees : {0.0, 0.001, 0.1, 1.0, 45.0, 90.0, 150.0, 179.0}) {
        for (int i = 0; i < 1000; ++i) {
            const Quaternion q = random_rotation(random);
            const Vec3 axis = random_rotation(random).rotate({0, 0, 1});
            const double s = std::sin(degrees / kDegrees / 2);
            const double c = std::cos(degrees / kDegrees / 2);
            const Quaternion turn{s * axis[0], s * axis[1], s * axis[2], c};
            TangentFrame turned{};
            for (int k = 0; k < 3; ++k) {
                turned.tangent[k] = static_cast<float>(turn.rotate(q.rotate({1, 0, 0}))[k]);
                turned.normal[k] = static_cast<float>(turn.rotate(q.rotate({0, 0, 1}))[k]);
            }
            turned.handedness = 1;
            const double angle = mesh_format::frame_angle(frame_of(q, false), turned);
            ASSERT_NEAR(angle, degrees, 1e-5 + (degrees > 90 ? 1e-3 : 0));
        }
    }
}

TEST(FrameAngle, IsZeroForTheSameFrameAndAHalfTurnForTheOtherHand) {
    const Quaternion q = Quaternion::unit(1, 2, 3, 4);
    EXPECT_EQ(mesh_format::frame_angle(frame_of(q, true), frame_of(q, true)), 0.0);
    EXPECT_EQ(mesh_format::frame_angle(frame_of(q, true), frame_of(q, false)), 180.0);
}

}  // namespace
