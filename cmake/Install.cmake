# What `cmake --install` copies besides the programs (vismem_program), by part: components, tools, gui, robot, gateway, data,
# dev.
#
#   PREFIX/libexec/vismem   programs          PREFIX/share/vismem/cfg    maps, palettes, worlds, scenarios, setups
#   PREFIX/bin/vismem       runs them         PREFIX/share/vismem/gui    the page in the browser
#   ETC/vismem/SETUP        setups of units   PREFIX/share/vismem/slice  Slice files
#   PREFIX/lib/systemd      units             PREFIX/include/vismem      headers of the libraries for drivers
#   PREFIX/LIB/vismem       these libraries   PREFIX/LIB/cmake/vismem    CMake package that finds them
#
# ETC is /etc for the prefix /usr, else PREFIX/etc.
set(shared ${CMAKE_INSTALL_DATADIR}/vismem)

install(DIRECTORY ${PROJECT_SOURCE_DIR}/cfg DESTINATION ${shared} COMPONENT data)
install(DIRECTORY ${CMAKE_BINARY_DIR}/gui DESTINATION ${shared} COMPONENT gui OPTIONAL)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/interfaces/ DESTINATION ${shared}/slice COMPONENT dev FILES_MATCHING PATTERN "*.ice")

# CMake's package `vismem`: the three hardware servers as static libraries with everything that they link and its headers, so
# that a program outside the project adds a driver to a server (docs/writing-a-driver.md).
include(InstalledLibraries)
vismem_install_libraries(camera_server_component pantilt_server_component base_server_component)
install(DIRECTORY deploy/driver_template DESTINATION ${shared} COMPONENT dev)

# Files with absolute paths in them are written at installation, when the prefix is known.
install(SCRIPT ${PROJECT_SOURCE_DIR}/deploy/install_robot.cmake COMPONENT robot)
install(SCRIPT ${PROJECT_SOURCE_DIR}/deploy/install_gui.cmake COMPONENT gui)
install(SCRIPT ${PROJECT_SOURCE_DIR}/deploy/install_gateway.cmake COMPONENT gateway)
install(PROGRAMS ${PROJECT_SOURCE_DIR}/deploy/pki/certificates ${PROJECT_SOURCE_DIR}/deploy/two_machines/make_setup
        DESTINATION ${CMAKE_INSTALL_LIBEXECDIR}/vismem COMPONENT tools)
install(SCRIPT ${PROJECT_SOURCE_DIR}/deploy/install_command.cmake COMPONENT components)
