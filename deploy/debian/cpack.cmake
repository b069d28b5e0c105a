# What CPack makes of the folder that deploy/package has filled. On its command line stand the version and the maintainer, in its
# environment CURVECAST_ROOT (the folder that becomes /) and CURVECAST_CONTROL (that of the scripts).
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME curvecast)
set(CPACK_PACKAGE_VENDOR Curvecast)
set(CPACK_PACKAGE_FILE_NAME curvecast)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "low-discrepancy point sampling of meshes, streamed")
set(CPACK_PACKAGE_DESCRIPTION
"Curvecast turns a triangle mesh into evenly spread, low-discrepancy point
sets: as many points as asked for, denser where a density or a view wants
them. Its server keeps prepared meshes and streams a new point set for every
view to its clients: browsers, commands, programs in any language with gRPC.

This is the command with its server, which has the viewer for browsers in it,
and the definition of the API.")
set(CPACK_INSTALLED_DIRECTORIES "$ENV{CURVECAST_ROOT}" /)
set(CPACK_PACKAGING_INSTALL_PREFIX /)

set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_DEPENDS adduser)
# Loaded when a picture is drawn; without it only those calls fail.
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS libosmesa6)
set(CPACK_DEBIAN_PACKAGE_SUGGESTS bash-completion)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
foreach(file conffiles postinst prerm postrm)
  list(APPEND CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA "$ENV{CURVECAST_CONTROL}/${file}")
endforeach()
