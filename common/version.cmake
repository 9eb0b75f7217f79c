# Writes OUTPUT, the implementation of version.h, unless it is that already. Run at every build, so
# that it knows the commit. Takes OUTPUT, SOURCES (the repository), VERSION and BUILD_TYPE.
set(details ${BUILD_TYPE})
# Not the commit of a repository that the sources merely lie in.
if(EXISTS ${SOURCES}/.git)
    execute_process(
        COMMAND git --no-optional-locks -c safe.directory=* -C ${SOURCES}
                describe --always --dirty --abbrev=10 --exclude=*
        OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
    list(PREPEND details ${commit})
endif()
list(JOIN details ", " details)
if(details)
    string(APPEND VERSION " (${details})")
endif()
file(CONFIGURE OUTPUT ${OUTPUT} @ONLY CONTENT [[
#include "common/version.h"

const char* common::version() {
    return "@VERSION@";
}
]])
