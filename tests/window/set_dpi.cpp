// set_dpi: what a desktop does to make everything larger.
//
// Usage: set_dpi DPI
#include <X11/Xatom.h>
#include <X11/Xlib.h>

#include <cstdio>
#include <string>

int main(int argc, char** argv) {
    Display* const display = argc == 2 ? XOpenDisplay(nullptr) : nullptr;
    if (display == nullptr) {
        std::fputs("set_dpi: no display, or not DPI\n", stderr);
        return 1;
    }
    const std::string resources = std::string("Xft.dpi:\t") + argv[1] + '\n';
    XChangeProperty(display, DefaultRootWindow(display), XA_RESOURCE_MANAGER, XA_STRING, 8,
                    PropModeReplace, reinterpret_cast<const unsigned char*>(resources.data()),
                    static_cast<int>(resources.size()));
    XCloseDisplay(display);
    return 0;
}
