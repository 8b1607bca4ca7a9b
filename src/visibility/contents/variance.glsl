// Mean and mean square of distances, which bound how much of what was averaged lies before the receiver:
// W. Donnelly, A. Lauritzen, "Variance Shadow Maps", I3D 2006.

#ifndef GNOMON_VISIBILITY_CONTENTS_VARIANCE_GLSL
#define GNOMON_VISIBILITY_CONTENTS_VARIANCE_GLSL

// What can lie behind `value` at most, when mean and mean square are known: Cantelli's inequality.
float most_behind(vec2 moments, float value, float least_variance) {
    float variance = max(moments.y - moments.x * moments.x, least_variance);
    float before = max(value - moments.x, 0.0);
    return variance / (variance + before * before);
}

#endif
