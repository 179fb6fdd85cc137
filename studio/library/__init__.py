"""The motion library: folders of captures, the clips found in them, and the search for a clip that hits."""
