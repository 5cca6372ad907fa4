# Writes shader sources as a C file: cmake -DOUT=<file.c> -DFILES="<file>;<file>..." -P embed.cmake
# Bytes rather than string literals, whose length the C standard limits.
set(text "/* Made by gpu/shaders/embed.cmake. */\n#include <string.h>\n\n#include \"gpu/gl_program.h\"\n\n")
set(rows "")
set(n 0)
foreach(file IN LISTS FILES)
    get_filename_component(name ${file} NAME)
    file(READ ${file} hex HEX)
    string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${hex}")
    string(APPEND text "static const char text_${n}[] = {${bytes}0};\n")
    string(APPEND rows "    {\"${name}\", text_${n}},\n")
    math(EXPR n "${n} + 1")
endforeach()
string(APPEND text "\nstatic const dif_gl_part PARTS[] = {\n${rows}};\n\n"
    "dif_gl_part dif_shader_part(const char *name)\n{\n"
    "    for (size_t i = 0; i < sizeof PARTS / sizeof *PARTS; i++)\n"
    "        if (strcmp(PARTS[i].name, name) == 0)\n            return PARTS[i];\n"
    "    return (dif_gl_part){name, NULL};\n}\n")
file(WRITE ${OUT} "${text}")
