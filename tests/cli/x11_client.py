# SPDX-License-Identifier: BSD-3-Clause
"""What other programs of a desktop do to a window, by libX11.

x11_client.py close WINDOW             as a window manager does
x11_client.py drop WINDOW PATH...      as a file manager does: XDND 5, text/uri-list; ends when the window took it
x11_client.py overlook FILE            as a window manager that is just starting: makes FILE when it listens, overlooks
                                       that a window wants to be shown, and shows one that asks again
"""

import ctypes
import sys
import urllib.parse

Long = ctypes.c_ulong
MAP_REQUEST, SELECTION_REQUEST, SELECTION_NOTIFY, CLIENT_MESSAGE = 20, 30, 31, 33
SUBSTRUCTURE_REDIRECT = 1 << 20


def event(name, *fields):
    """An event of X as a C structure of that size; the first fields are those of all events."""
    first = [("type", ctypes.c_int), ("serial", Long), ("send_event", ctypes.c_int), ("display", ctypes.c_void_p)]
    return type(name, (ctypes.Structure,), {"_fields_": first + list(fields)})


Message = event("Message", ("window", Long), ("message_type", Long), ("format", ctypes.c_int), ("data", ctypes.c_long * 5))
Request = event("Request", ("requestor", Long), ("wanted_by", Long), ("selection", Long), ("target", Long),
                ("property", Long), ("time", Long))  # the first of these is the owner
Notify = event("Notify", ("requestor", Long), ("selection", Long), ("target", Long), ("property", Long), ("time", Long))

Mapping = event("Mapping", ("parent", Long), ("window", Long))


class Event(ctypes.Union):
    _fields_ = [("type", ctypes.c_int), ("message", Message), ("request", Request), ("notify", Notify),
                ("mapping", Mapping), ("room", ctypes.c_long * 24)]


x11 = ctypes.CDLL("libX11.so.6")
for function, result, arguments in (
        ("XOpenDisplay", ctypes.c_void_p, [ctypes.c_char_p]),
        ("XDefaultRootWindow", Long, [ctypes.c_void_p]),
        ("XCreateSimpleWindow", Long, [ctypes.c_void_p, Long] + 4 * [ctypes.c_int] + [ctypes.c_uint, Long, Long]),
        ("XInternAtom", Long, [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int]),
        ("XSetSelectionOwner", ctypes.c_int, [ctypes.c_void_p, Long, Long, Long]),
        ("XChangeProperty", ctypes.c_int, [ctypes.c_void_p, Long, Long, Long, ctypes.c_int, ctypes.c_int,
                                           ctypes.c_char_p, ctypes.c_int]),
        ("XSendEvent", ctypes.c_int, [ctypes.c_void_p, Long, ctypes.c_int, ctypes.c_long, ctypes.c_void_p]),
        ("XSelectInput", ctypes.c_int, [ctypes.c_void_p, Long, ctypes.c_long]),
        ("XMapWindow", ctypes.c_int, [ctypes.c_void_p, Long]),
        ("XNextEvent", ctypes.c_int, [ctypes.c_void_p, ctypes.c_void_p]),
        ("XSync", ctypes.c_int, [ctypes.c_void_p, ctypes.c_int])):
    getattr(x11, function).restype = result
    getattr(x11, function).argtypes = arguments
display = x11.XOpenDisplay(None)


def atom(name):
    return x11.XInternAtom(display, name.encode(), 0)


def send(window, name, *data):
    sent = Event()
    sent.message = Message(CLIENT_MESSAGE, 0, 1, display, window, atom(name), 32, (ctypes.c_long * 5)(*data))
    x11.XSendEvent(display, window, 0, 0, ctypes.byref(sent))
    x11.XSync(display, 0)


def give(request, text):
    """Puts the text where the request wants it, and says so."""
    x11.XChangeProperty(display, request.wanted_by, request.property, request.target, 8, 0, text, len(text))
    sent = Event()
    sent.notify = Notify(SELECTION_NOTIFY, 0, 1, display, request.wanted_by, request.selection, request.target,
                         request.property, request.time)
    x11.XSendEvent(display, request.wanted_by, 0, 0, ctypes.byref(sent))
    x11.XSync(display, 0)


def drop(window, paths):
    text = "".join("file://" + urllib.parse.quote(path) + "\r\n" for path in paths).encode()
    own = x11.XCreateSimpleWindow(display, x11.XDefaultRootWindow(display), 0, 0, 1, 1, 0, 0, 0)
    x11.XSetSelectionOwner(display, atom("XdndSelection"), own, 0)
    send(window, "XdndEnter", own, 5 << 24, atom("text/uri-list"))
    send(window, "XdndPosition", own, 0, 20 << 16 | 200, 0, atom("XdndActionCopy"))  # the rail: nothing is pointed at
    heard = Event()
    while True:
        x11.XNextEvent(display, ctypes.byref(heard))
        if heard.type == SELECTION_REQUEST:
            give(heard.request, text)
        elif heard.type == CLIENT_MESSAGE and heard.message.message_type == atom("XdndStatus"):
            assert heard.message.data[1] & 1, "the window takes no drops"
            send(window, "XdndDrop", own, 0, 0)
        elif heard.type == CLIENT_MESSAGE and heard.message.message_type == atom("XdndFinished"):
            return


def overlook(path):
    x11.XSelectInput(display, x11.XDefaultRootWindow(display), SUBSTRUCTURE_REDIRECT)
    x11.XSync(display, 0)
    open(path, "w").close()
    heard = Event()
    asked = 0
    while asked < 2:
        x11.XNextEvent(display, ctypes.byref(heard))
        asked += heard.type == MAP_REQUEST
    x11.XMapWindow(display, heard.mapping.window)
    x11.XSync(display, 0)


if sys.argv[1] == "close":
    send(int(sys.argv[2]), "WM_PROTOCOLS", atom("WM_DELETE_WINDOW"))
elif sys.argv[1] == "overlook":
    overlook(sys.argv[2])
else:
    drop(int(sys.argv[2]), sys.argv[3:])
