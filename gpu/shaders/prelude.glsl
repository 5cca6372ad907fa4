precision highp float;
precision highp int;
precision highp sampler2D;
precision highp sampler2DArray;

#define DIF_PI     3.14159265358979
#define DIF_TWO_PI 6.28318530717959
