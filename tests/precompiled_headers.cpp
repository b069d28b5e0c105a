// CMake takes precompiled headers from a target, and a target has a source.
