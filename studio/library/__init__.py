"""The motion library: folders of captures, the clips cut from them, and the search for one that hits."""
