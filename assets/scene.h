// The courtyard: what stands where. Metres, +Y up, the court's floor at y = 0; two wings along -x
// and -z, open towards +x and +z.
#pragma once

#include "assets/model.h"

namespace assets {

inline constexpr float kBay = 2.4f;       ///< from column to column
inline constexpr int kLongBays = 6;       ///< along x, the wing at -z
inline constexpr int kShortBays = 4;      ///< along z, the wing at -x
inline constexpr float kArcadeX = -6.0f;  ///< the short arcade's centre plane
inline constexpr float kArcadeZ = -3.6f;  ///< the long arcade's centre plane
inline constexpr float kEndX = kArcadeX + kBay * kLongBays;
inline constexpr float kEndZ = kArcadeZ + kBay * kShortBays;
inline constexpr float kGallery = 2.4f;    ///< from the arcade to the back wall
inline constexpr float kWallDepth = 0.5f;  ///< of the arcades
inline constexpr float kLowerFloor = 0.15f;
inline constexpr float kUpperFloor = 4.1f;
inline constexpr float kColumn = 2.35f;       ///< from a floor to an arch's springing, lower
inline constexpr float kUpperColumn = 1.95f;  ///< the same, upper storey
inline constexpr float kArchRadius = 0.95f;
inline constexpr float kWallTop = 7.35f;  ///< of the upper arcade
inline constexpr glm::vec3 kSculpture{1.2f, 0.0f, 1.2f};

void add_arcades(Model& model);
void add_walls_and_floors(Model& model);
void add_roof(Model& model);
void add_sculpture(Model& model);    ///< pool, plinth and the lion's head
void add_furnishings(Model& model);  ///< curtains, carpets, lanterns, chains, posts
void add_plants(Model& model);

/// All of the above.
Model courtyard();

}  // namespace assets
