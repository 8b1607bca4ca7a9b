// The colour map viridis (S. van der Walt, N. Smith, 2015) as a polynomial of degree 6 in sRGB, fitted
// by M. Zucker, 2019: "viridis", shadertoy.com/view/WlfXRN, in the public domain.
const COEFFICIENTS = [
  [0.2777273272234177, 0.005407344544966578, 0.3340998053353061],
  [0.1050930431085774, 1.404613529898575, 1.384590162594685],
  [-0.3308618287255563, 0.214847559468213, 0.09509516302823659],
  [-4.634230498983486, -5.799100973351585, -19.33244095627987],
  [6.228269936347081, 14.17993336680509, 56.69055260068105],
  [4.776384997670288, -13.74514537774601, -65.35303263337234],
  [-5.435455855934631, 4.645852612178535, 26.3124352495832],
];

// The same in GLSL: vec3 false_color(float part).
export const falseColorGlsl = `vec3 false_color(float part) {
    float t = clamp(part, 0.0, 1.0);
    return ${COEFFICIENTS.map((c) => `vec3(${c.map((n) => n.toFixed(9)).join(", ")})`).join(" + t * (")}${")".repeat(COEFFICIENTS.length - 1)};
}
`;

const falseColor = (part) => {
  const rgb = [0, 1, 2].map((i) => COEFFICIENTS.reduceRight((sum, c) => sum * part + c[i], 0));
  return `rgb(${rgb.map((v) => Math.round(255 * Math.min(Math.max(v, 0), 1))).join(" ")})`;
};

// A CSS gradient from the least to the most.
export const falseColorGradient = (stops = 16) => {
  const colors = Array.from({ length: stops + 1 }, (_, i) => falseColor(i / stops));
  return `linear-gradient(to right, ${colors.join(", ")})`;
};
