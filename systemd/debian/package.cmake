# `cpack -G DEB` in a build folder, which ./dev deb runs: gimbald, and gimbald-calibration with what
# stands on OpenCV and Ceres, so that a camera need not carry these.
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL Unspecified)
set(CPACK_DEBIAN_UNSPECIFIED_PACKAGE_NAME ${PROJECT_NAME})
if(TARGET gimbalctl-calibrate OR TARGET gimbald-corners)
  list(APPEND CPACK_COMPONENTS_ALL calibration)
endif()
set(CPACK_PACKAGE_CONTACT "The gimbald authors <gimbald@localhost>")
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION video)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# Beside the libraries: GStreamer's plugins are found while running, and the postinst makes the user.
set(CPACK_DEBIAN_UNSPECIFIED_PACKAGE_DEPENDS
    "gstreamer1.0-plugins-base, gstreamer1.0-plugins-good, systemd | systemd-standalone-sysusers")
set(CPACK_DEBIAN_UNSPECIFIED_PACKAGE_RECOMMENDS
    "gstreamer1.0-plugins-ugly, gstreamer1.0-plugins-bad, gstreamer1.0-libav, libegl-mesa0, libgl1-mesa-dri, udev")
set(CPACK_DEBIAN_UNSPECIFIED_PACKAGE_SUGGESTS "gimbald-calibration, libcamera-ipa, bash-completion")
set(CPACK_DEBIAN_UNSPECIFIED_DESCRIPTION
"gimbald takes frames and gyroscope samples, works out where the camera
pointed while every single row was exposed, and draws each frame again as if
all its rows had been exposed at once by a steady camera.
.
Cameras come through V4L2 or libcamera, motion sensors through the kernel's
IIO or on I2C; pictures go to RTSP, files, v4l2loopback or any GStreamer
pipeline. gimbalctl does the same with recordings.")
set(CPACK_DEBIAN_CALIBRATION_PACKAGE_NAME ${PROJECT_NAME}-calibration)
set(CPACK_DEBIAN_CALIBRATION_PACKAGE_DEPENDS "${PROJECT_NAME} (= ${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE})")
set(CPACK_DEBIAN_CALIBRATION_DESCRIPTION
"With this gimbalctl sync finds time offset, readout time and axes from an
ordinary recording, and gimbalctl calibrate intrinsics a lens from pictures
of a board, and the daemon tracks the time offset as it runs. It does
without where this is not installed.")
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
    OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_PRE_BUILD_SCRIPTS ${CMAKE_CURRENT_LIST_DIR}/documents.cmake)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_UNSPECIFIED_PACKAGE_CONTROL_EXTRA
    ${CMAKE_CURRENT_LIST_DIR}/conffiles ${CMAKE_CURRENT_LIST_DIR}/postinst
    ${CMAKE_CURRENT_LIST_DIR}/prerm ${CMAKE_CURRENT_LIST_DIR}/postrm)
include(CPack)
