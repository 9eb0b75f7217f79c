// minimise: what a window manager does to minimise a window, and to bring it back.
//
// Usage: minimise WINDOW yes|no
#include <X11/Xatom.h>
#include <X11/Xlib.h>
#include <X11/Xutil.h>

#include <cstdio>
#include <cstdlib>
#include <string_view>

int main(int argc, char** argv) {
    Display* const display = argc == 3 ? XOpenDisplay(nullptr) : nullptr;
    if (display == nullptr) {
        std::fputs("minimise: no display, or not WINDOW yes|no\n", stderr);
        return 1;
    }
    const Window window = std::strtoul(argv[1], nullptr, 0);
    const bool yes = std::string_view(argv[2]) == "yes";
    // The property says it (ICCCM 4.1.3.1).
    const Atom property = XInternAtom(display, "WM_STATE", False);
    const long state[] = {yes ? IconicState : NormalState, None};
    if (!yes) XMapWindow(display, window);
    XChangeProperty(display, window, property, property, 32, PropModeReplace,
                    reinterpret_cast<const unsigned char*>(state), 2);
    if (yes) XUnmapWindow(display, window);
    XCloseDisplay(display);
    return 0;
}
