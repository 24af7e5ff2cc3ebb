# `cpack -G DEB` in a build folder makes a package for the system on which it is built, which depends on the libraries that the
# program was linked with. tools/make_portable.sh makes a folder or an archive that brings them.
set(CPACK_PACKAGE_NAME pertev)
set(CPACK_PACKAGE_CONTACT "Pertev's authors")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "photo-realistic path tracer for GPUs without ray-tracing hardware, and for CPUs")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_GENERATOR DEB)
include(CPack)
