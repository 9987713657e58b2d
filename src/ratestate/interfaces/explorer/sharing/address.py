"""Where the page is found."""

#: the port tried first if none is given
PORT = 8765


def address_of(port, fragment=""):
    """The page's address, which opens it with a slider (see `entries.fragment_of`)."""
    return f"http://127.0.0.1:{port}/{fragment and '#'}{fragment}"
