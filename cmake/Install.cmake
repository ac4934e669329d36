# What `cmake --install` copies besides the programs (vismem_program), by part: components, tools, gui, robot, data, dev.
#
#   PREFIX/libexec/vismem   programs          PREFIX/share/vismem/cfg    maps, palettes, worlds, scenarios, setups
#   PREFIX/bin/vismem       runs them         PREFIX/share/vismem/gui    the page in the browser
#   ETC/vismem/SETUP        setups of units   PREFIX/share/vismem/slice  Slice files
#   PREFIX/lib/systemd      units             PREFIX/include/vismem      headers of the ports
#
# ETC is /etc for the prefix /usr, else PREFIX/etc.
set(shared ${CMAKE_INSTALL_DATADIR}/vismem)

install(DIRECTORY ${PROJECT_SOURCE_DIR}/cfg DESTINATION ${shared} COMPONENT data)
install(DIRECTORY ${CMAKE_BINARY_DIR}/gui DESTINATION ${shared} COMPONENT gui OPTIONAL)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/interfaces/ DESTINATION ${shared}/slice COMPONENT dev FILES_MATCHING PATTERN "*.ice")

# A port and everything that its header includes.
set(headers ${CMAKE_INSTALL_INCLUDEDIR}/vismem/common)
install(FILES components/common/geometry/angles.h components/common/geometry/camera.h components/common/geometry/pose.h
        DESTINATION ${headers}/geometry COMPONENT dev)
install(FILES components/common/robot/control_ports.h components/common/robot/ports.h components/common/robot/samples.h
        DESTINATION ${headers}/robot COMPONENT dev)

# Files with absolute paths in them are written at installation, when the prefix is known.
install(SCRIPT ${PROJECT_SOURCE_DIR}/deploy/install_robot.cmake COMPONENT robot)
install(SCRIPT ${PROJECT_SOURCE_DIR}/deploy/install_gui.cmake COMPONENT gui)
install(SCRIPT ${PROJECT_SOURCE_DIR}/deploy/install_command.cmake COMPONENT components)
