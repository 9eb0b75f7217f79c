// Which version of the sources this is. The implementation is written by version.cmake.
#pragma once

namespace common {

/// "VERSION (COMMIT, BUILD TYPE)"; "-dirty" behind the commit where files differ from it. What is
/// not known is left out.
const char* version();

}  // namespace common
