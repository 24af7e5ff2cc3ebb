# Run at build time (cmake -P): writes OUTPUT, a .cpp that holds the text of FILES (absolute paths, `|` between them) as the
# viewer serves them: index.html is "/", every other file is found under its name.

string(REPLACE "|" ";" FILES "${FILES}")
set(arrays "")
set(rows "")
set(type_html "text/html; charset=utf-8")
set(type_js "text/javascript; charset=utf-8")
set(type_css "text/css; charset=utf-8")
set(type_svg "image/svg+xml")
foreach(file IN LISTS FILES)
  get_filename_component(name ${file} NAME)
  get_filename_component(extension ${file} LAST_EXT)
  string(SUBSTRING ${extension} 1 -1 extension)
  if(NOT DEFINED type_${extension})
    continue() # not the page's: notes for tsc
  endif()
  string(MAKE_C_IDENTIFIER ${name} identifier)
  file(READ ${file} bytes HEX)
  string(REPEAT "." 64 line)
  string(REGEX REPLACE "(${line})" "\\1\n    " bytes "${bytes}")
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "'\\\\x\\1'," bytes "${bytes}")
  string(APPEND arrays "constexpr char ${identifier}[] = {\n    ${bytes}};\n")
  set(path "/${name}")
  if(name STREQUAL "index.html")
    set(path "/")
  endif()
  string(APPEND rows "        {\"${path}\", \"${type_${extension}}\", {${identifier}, sizeof ${identifier}}},\n")
endforeach()

file(WRITE ${OUTPUT}.new "// Written by apps/viewer/embed_page.cmake.
#include \"apps/viewer/web_server.h\"

namespace pertev {
namespace {

${arrays}
} // namespace

std::vector<PageFile> page_files() {
    return {
${rows}    };
}

} // namespace pertev
")
file(RENAME ${OUTPUT}.new ${OUTPUT})
