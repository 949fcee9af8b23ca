# cmake -DPROGRAM=P -DARGUMENTS=a;b -DOUT=FILE -P capture.cmake: what the program prints, as a file
execute_process(COMMAND ${PROGRAM} ${ARGUMENTS} OUTPUT_FILE ${OUT} COMMAND_ERROR_IS_FATAL ANY)
