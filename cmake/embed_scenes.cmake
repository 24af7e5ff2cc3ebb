# Run at build time (cmake -P): writes OUTPUT, a .cpp that holds the bytes of FILES (absolute paths, `|` between them) and
# finds them by their names without extension.

string(REPLACE "|" ";" FILES "${FILES}")
set(arrays "")
set(rows "")
foreach(file IN LISTS FILES)
  get_filename_component(name ${file} NAME_WE)
  string(MAKE_C_IDENTIFIER ${name} identifier)
  file(READ ${file} bytes HEX)
  string(REPEAT "." 48 line)
  string(REGEX REPLACE "(${line})" "\\1\n    " bytes "${bytes}")
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${bytes}")
  string(APPEND arrays "constexpr unsigned char ${identifier}[] = {\n    ${bytes}};\n")
  string(APPEND rows "    {\"${name}\", ${identifier}},\n")
endforeach()

configure_file(${CMAKE_CURRENT_LIST_DIR}/builtin_scenes.cpp.in ${OUTPUT} @ONLY)
