# For 64-bit ARM on a Debian of another architecture: crossbuild-essential-arm64, the libraries' :arm64
# packages beside the machine's own (multiarch), and qemu-user for what is run while building and testing.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)

# Looks where the architecture's .pc files are; pkgconf:arm64 has it.
set(PKG_CONFIG_EXECUTABLE /usr/bin/aarch64-linux-gnu-pkg-config)
# Finds the loader and the libraries by itself, since multiarch keeps them where an ARM machine has them.
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64)

# CPack would ask dpkg, which answers for the machine that builds.
set(CPACK_DEBIAN_PACKAGE_ARCHITECTURE arm64)
