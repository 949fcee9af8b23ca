# cmake -DOUT=FILE.c -DFILE=F -DNAME=N -P embed.cmake: the file as a C string N
file(READ "${FILE}" text)
string(REPLACE "\\" "\\\\" text "${text}")
string(REPLACE "\"" "\\\"" text "${text}")
string(REPLACE "\n" "\\n\"\n    \"" text "${text}")
file(WRITE "${OUT}" "/* Made by embed.cmake. */\nextern const char ${NAME}[];\nconst char ${NAME}[] =\n    \"${text}\";\n")
