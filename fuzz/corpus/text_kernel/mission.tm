KPL/MK
\begindata
PATH_VALUES = ( 'kernels' )
PATH_SYMBOLS = ( 'K' )
KERNELS_TO_LOAD = ( '$K/a_long_+'
                    'name.tpc' )
\begintext
