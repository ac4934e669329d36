# Part `gateway` of an installation, apart from its program: units, routers, users.
include(${CMAKE_CURRENT_LIST_DIR}/paths.cmake)

install_file(systemd/vismem-gateway_access.service.in ${units}/vismem-gateway_access.service)
install_file(systemd/vismem-gateway@.service.in ${units}/vismem-gateway@.service)
install_file(systemd/vismem-gateway.target ${units}/vismem-gateway.target)
install_file(gateway/gateway_user ${PROGRAMS}/gateway_user EXECUTABLE)
foreach(name gateway_access operator viewer)
  file(INSTALL ${CMAKE_CURRENT_LIST_DIR}/gateway/${name}.cfg DESTINATION ${SETUPS}/gateway)
endforeach()
