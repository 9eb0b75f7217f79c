// drop: what a file manager does when files are dragged onto a window and dropped there (XDND 5).
//
// Usage: drop WINDOW PATH...; ends when the window has taken them, with status 1 if it does not.
#include <X11/Xatom.h>
#include <X11/Xlib.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <string>

namespace {

class Source {
 public:
    Source(Display* display, Window target, const std::string& uris)
        : display_(display), target_(target), uris_(uris) {
        own_ = XCreateSimpleWindow(display, DefaultRootWindow(display), 0, 0, 1, 1, 0, 0, 0);
        XSetSelectionOwner(display, atom("XdndSelection"), own_, CurrentTime);
    }

    bool drop() {
        const auto source = static_cast<long>(own_);
        send("XdndEnter", {source, 5L << 24, static_cast<long>(atom("text/uri-list"))});
        send("XdndPosition",
             {source, 0, 0, CurrentTime, static_cast<long>(atom("XdndActionCopy"))});
        XEvent event;
        for (;;) {
            XNextEvent(display_, &event);
            if (event.type == SelectionRequest) answer(event.xselectionrequest);
            if (event.type != ClientMessage) continue;
            const Atom message = event.xclient.message_type;
            // GLFW 3.3 finishes with the number of bytes that it took instead of bit 0.
            const bool accepted = event.xclient.data.l[1] != 0;
            if (message == atom("XdndStatus")) {
                if (!accepted) return false;
                send("XdndDrop", {source, 0, CurrentTime});
            } else if (message == atom("XdndFinished")) {
                return accepted;
            }
        }
    }

 private:
    Atom atom(const char* name) const { return XInternAtom(display_, name, False); }

    void send(const char* message, const std::array<long, 5>& data) {
        XEvent event{};
        event.xclient.type = ClientMessage;
        event.xclient.window = target_;
        event.xclient.message_type = atom(message);
        event.xclient.format = 32;
        for (std::size_t i = 0; i < data.size(); ++i) event.xclient.data.l[i] = data[i];
        XSendEvent(display_, target_, False, NoEventMask, &event);
        XFlush(display_);
    }

    void answer(const XSelectionRequestEvent& request) {
        XChangeProperty(display_, request.requestor, request.property, request.target, 8,
                        PropModeReplace, reinterpret_cast<const unsigned char*>(uris_.data()),
                        static_cast<int>(uris_.size()));
        XEvent event{};
        event.xselection.type = SelectionNotify;
        event.xselection.requestor = request.requestor;
        event.xselection.selection = request.selection;
        event.xselection.target = request.target;
        event.xselection.property = request.property;
        event.xselection.time = request.time;
        XSendEvent(display_, request.requestor, False, NoEventMask, &event);
        XFlush(display_);
    }

    Display* display_;
    Window own_;
    Window target_;
    std::string uris_;
};

}  // namespace

int main(int argc, char** argv) {
    Display* const display = argc >= 3 ? XOpenDisplay(nullptr) : nullptr;
    if (display == nullptr) {
        std::fputs("drop: no display, or not WINDOW PATH...\n", stderr);
        return 1;
    }
    std::string uris;
    for (int i = 2; i < argc; ++i) uris += "file://" + std::string(argv[i]) + "\r\n";
    const bool dropped = Source(display, std::strtoul(argv[1], nullptr, 0), uris).drop();
    XCloseDisplay(display);
    return dropped ? 0 : 1;
}
