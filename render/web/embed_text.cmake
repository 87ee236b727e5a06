# Makes of a text file a C++ string literal: cmake -DIN=FILE -DOUT=FILE -P embed_text.cmake. #include it where a literal may
# stand.
file(READ "${IN}" text)
file(WRITE "${OUT}" "R\"_text_(${text})_text_\"\n")
