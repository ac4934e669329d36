# Generates and builds C++ from Slice files as one static library with the C++11 mapping.
find_package(Ice 3.7 REQUIRED COMPONENTS Ice++11)

# slice_library(NAME ROOT folder SOURCES path/relative/to/root.ice ...)
# Generated headers are included by the same relative path: <avm/camera.h>.
function(slice_library name)
  cmake_parse_arguments(A "" "ROOT" "SOURCES" ${ARGN})
  set(generated_root ${CMAKE_CURRENT_BINARY_DIR}/generated)
  set(sources)
  foreach(slice IN LISTS A_SOURCES)
    get_filename_component(folder ${slice} DIRECTORY)
    get_filename_component(base ${slice} NAME_WE)
    set(output_dir ${generated_root}/${folder})
    file(MAKE_DIRECTORY ${output_dir})
    set(input ${A_ROOT}/${slice})
    set(depfile ${output_dir}/${base}.d)
    set(include_flags -I${A_ROOT} -I${Ice_SLICE_DIR})
    add_custom_command(
      OUTPUT ${output_dir}/${base}.cpp ${output_dir}/${base}.h
      COMMAND ${Ice_SLICE2CPP_EXECUTABLE} ${include_flags} --include-dir ${folder} --output-dir ${output_dir} ${input}
      # --depend names the header without its folder, which Ninja would not recognise as this output.
      COMMAND ${Ice_SLICE2CPP_EXECUTABLE} ${include_flags} --depend --depend-file ${depfile}.raw ${input}
      COMMAND sed "1s|^[^:]*:|${output_dir}/${base}.cpp:|" ${depfile}.raw > ${depfile}
      DEPENDS ${input}
      DEPFILE ${depfile}
      COMMENT "slice2cpp ${slice}"
      VERBATIM)
    list(APPEND sources ${output_dir}/${base}.cpp)
  endforeach()
  add_library(${name} STATIC ${sources})
  target_include_directories(${name} SYSTEM PUBLIC $<BUILD_INTERFACE:${generated_root}>
                                                   $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/vismem>)
  set_target_properties(${name} PROPERTIES GENERATED_HEADERS ${generated_root})
  # PUBLIC, so that nobody mixes the C++98 and C++11 mappings.
  target_compile_definitions(${name} PUBLIC ICE_CPP11_MAPPING)
  target_link_libraries(${name} PUBLIC Ice::Ice++11 Threads::Threads)
endfunction()
