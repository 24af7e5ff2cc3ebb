# Run at build time (cmake -P): writes OUTPUT, a .cpp that holds the bytes of FILES (absolute paths, `|` between them) and
# finds them by their names without extension. Beside an .obj file stands the .mtl file of its name, which is taken too.

string(REPLACE "|" ";" FILES "${FILES}")
set(arrays "")
set(rows "")

# Appends the bytes of a file to `arrays`, as an array of this name.
function(embed file identifier)
  file(READ ${file} bytes HEX)
  string(REPEAT "." 48 line)
  string(REGEX REPLACE "(${line})" "\\1\n    " bytes "${bytes}")
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${bytes}")
  set(arrays "${arrays}constexpr unsigned char ${identifier}[] = {\n    ${bytes}};\n" PARENT_SCOPE)
endfunction()

foreach(file IN LISTS FILES)
  get_filename_component(name ${file} NAME_WE)
  get_filename_component(extension ${file} EXT)
  string(MAKE_C_IDENTIFIER "${name}_scene" identifier)
  embed(${file} ${identifier})
  set(materials "{}")
  if(extension STREQUAL ".obj")
    get_filename_component(folder ${file} DIRECTORY)
    set(materials ${identifier}_materials)
    embed(${folder}/${name}.mtl ${materials})
  endif()
  string(APPEND rows "    {\"${name}\", ${identifier}, ${materials}},\n")
endforeach()

configure_file(${CMAKE_CURRENT_LIST_DIR}/builtin_scenes.cpp.in ${OUTPUT} @ONLY)
