#version 460

// Writes a specialization constant.

layout(local_size_x = 1) in;

layout(constant_id = 0) const uint kValue = 0;

layout(set = 0, binding = 0) writeonly buffer Result { uint result; };

void main() {
    result = kValue;
}
