{% for line in head %}
% {{ line }}
{% endfor %}
function {{ "[xdot, U]" if has_speed else "xdot" }} = {{ name }}(x, ui, p)
% {{ name }}  {{ meaning }}
%
%   {{ "[xdot, U]" if has_speed else "xdot" }} = {{ name }}(x, ui) returns the rates of the states{{ " and the speed U [m/s]" if has_speed }}.
%   {{ name }}(x, ui, p) takes other parameters, a struct as in {{ name }}.mat.
%
%   x = [ {{ states|map(attribute="name")|join(" ") }} ]'
{% for v in states %}
%     {{ v.name }} [{{ v.unit or "1" }}] {{ v.note }}
{% endfor %}
%   ui = [ {{ inputs|map(attribute="name")|join(" ") }} ]'
{% for v in inputs %}
%     {{ v.name }} [{{ v.unit or "1" }}] {{ v.note }}
{% endfor %}
if numel(x) ~= {{ states|length }}
    error('{{ name }}: x needs {{ states|length }} elements')
end
if numel(ui) ~= {{ inputs|length }}
    error('{{ name }}: ui needs {{ inputs|length }} elements')
end
if nargin < 3
    p = identified_parameters();
end
u = ui;
out = zeros({{ states|length }}, 1);
{% for line in rates %}
{{ line }};
{% endfor %}
xdot = out;
{% if has_speed %}
U = {{ speed }};
{% endif %}
end

function value = choose(condition, first, second)
if condition
    value = first;
else
    value = second;
end
end

function value = sign_of(x)
value = choose(x < 0, -1, 1);
end

function p = identified_parameters()
{% for v, value in parameters %}
p.{{ v.name }} = {{ value }}; % [{{ v.unit }}] {{ v.note }}
{% else %}
p = struct();
{% endfor %}
end
