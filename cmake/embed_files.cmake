# Run at build time (cmake -P): writes OUTPUT, a .cpp that holds the bytes of FILES (absolute paths, `|` between them) for
# embedded_file() of lab/report_page.h.
string(REPLACE "|" ";" FILES "${FILES}")
set(rows "")
foreach(file IN LISTS FILES)
  get_filename_component(name ${file} NAME)
  file(READ ${file} bytes HEX)
  string(REPEAT "." 64 line)
  string(REGEX REPLACE "(${line})" "\\1\n    " bytes "${bytes}")
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "'\\\\x\\1'," bytes "${bytes}")
  string(MAKE_C_IDENTIFIER ${name} identifier)
  string(APPEND arrays "constexpr char ${identifier}[] = {\n    ${bytes}};\n")
  string(APPEND rows "    if (name == \"${name}\") return {${identifier}, sizeof ${identifier}};\n")
endforeach()
file(WRITE ${OUTPUT}.new "#include \"lab/report_page.h\"\n\nnamespace pertev {\nnamespace {\n\n${arrays}\n} // namespace\n
std::string_view embedded_file(std::string_view name) {\n${rows}    return {};\n}\n\n} // namespace pertev\n")
file(RENAME ${OUTPUT}.new ${OUTPUT})
