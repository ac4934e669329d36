# Part `components` of an installation, apart from the programs: the command `vismem` and its page.
include(${CMAKE_CURRENT_LIST_DIR}/paths.cmake)
install_file(vismem.in ${CMAKE_INSTALL_PREFIX}/bin/vismem EXECUTABLE)
install_file(vismem.1.in ${CMAKE_INSTALL_PREFIX}/share/man/man1/vismem.1)
