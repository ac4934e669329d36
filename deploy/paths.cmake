# For the scripts of `cmake --install`: where things are in the installation, and how a file with such paths is written.
# The variables are those of the *.in files: @PROGRAMS@, @SETUPS@, @DATA@.
cmake_policy(VERSION 3.25)

set(PROGRAMS ${CMAKE_INSTALL_PREFIX}/libexec/vismem)
set(DATA ${CMAKE_INSTALL_PREFIX}/share/vismem)
if(CMAKE_INSTALL_PREFIX STREQUAL "/usr")
  set(etc /etc)
  set(lib /lib)
else()
  set(etc ${CMAKE_INSTALL_PREFIX}/etc)
  set(lib ${CMAKE_INSTALL_PREFIX}/lib)
endif()
set(SETUPS ${etc}/vismem)
set(units ${lib}/systemd/system)

# The programs that run as units. Recorder and mapper start on request only.
set(components active_visual_memory base_server camera_server fleet_agent localization mapper pantilt_server recorder replay_server simulator)

# install_file(INPUT OUTPUT [EXECUTABLE]): replaces @NAME@ and writes OUTPUT, a path of the installation.
function(install_file input output)
  set(target $ENV{DESTDIR}${output})
  message(STATUS "Installing: ${target}")
  configure_file(${CMAKE_CURRENT_LIST_DIR}/${input} ${target} @ONLY)
  set(mode OWNER_READ OWNER_WRITE GROUP_READ WORLD_READ)
  if("EXECUTABLE" IN_LIST ARGN)
    list(APPEND mode OWNER_EXECUTE GROUP_EXECUTE WORLD_EXECUTE)
  endif()
  file(CHMOD ${target} PERMISSIONS ${mode})
endfunction()
