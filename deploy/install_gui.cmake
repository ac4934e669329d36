# Part `gui` of an installation, apart from program and page: its unit, and the secret that components share with it.
include(${CMAKE_CURRENT_LIST_DIR}/paths.cmake)

install_file(systemd/component@.service.in ${units}/vismem-gui_server@.service)
install_file(systemd/vismem-token@.service.in ${units}/vismem-token@.service)
foreach(component IN LISTS components ITEMS gui_server)
  install_file(systemd/page.conf ${units}/vismem-${component}@.service.d/20-page.conf)
endforeach()
