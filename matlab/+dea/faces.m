function f = faces(mesh)
  % Quadrilaterals for patch: one row of four points each, every cell in order^2 of them; of solid
  % cells the two sides (bottom and top).
  %
  %   patch('Vertices', 1e3 * (m.points + m.fields.displacement_m), 'Faces', dea.faces(m), ...)
  f = zeros(0, 4);
  for c = mesh.cells(:)'
    n = c.order + 1;
    for side = unique([0, c.order_z])
      for j = 0:c.order - 1
        for i = 1:c.order
          first = side * n^2 + j * n + i;
          f = [f; c.nodes(:, first + [0, 1, n + 1, n])];
        end
      end
    end
  end
end
